// The optimum of the edges that agree: graduated non-convexity with truncated least squares (Yang et al. 2020,
// "Graduated Non-Convexity for Robust Spatial Perception"), then every edge tested against the others until the split
// stands.
#pragma once

#include "server/graph/edge_checks.h"

namespace rigcal::graph {

struct RobustOptimum {
  bool available = false;
  Poses T_ref;
  std::vector<bool> kept;     // per constraint
  std::vector<double> limit;  // of T^2 per constraint; infinity: cannot be tested, always kept
  EdgeChecks checks;          // at T_ref, rejected edges held out
};

// Limit of T^2: chi-square where the covariance is known, Hotelling's where it was estimated; `probability` is that of
// all edges together passing where all are good.
[[nodiscard]] double LimitOf(const Constraint& constraint, int dof, std::size_t edge_count, double probability);

// `start`: the plain optimum. `dof` per constraint. Not available beyond kChecksSensorsMax sensors, or where the split
// does not come to rest.
[[nodiscard]] RobustOptimum OptimizeRobustly(const Problem& problem, const Poses& start, const std::vector<int>& dof,
                                             double probability);

}  // namespace rigcal::graph
