// The sensor graph: min sum e^T Omega e over SE(3)^N, e = Log(T_ij_measured^-1 T_i^-1 T_j), the reference fixed
// (paper, section III-B). Pure and deterministic: edges are sorted by id, the start is fixed, one thread.
#pragma once

#include <vector>

#include "server/model/graph/graph.h"

namespace rigcal::graph {

struct SolveOptions {
  int iterations_max = 100;
  bool marginals = true;
};

// Canonical batch solve: spanning tree of the most certain edges, then Gauss-Newton with Levenberg-Marquardt fallback.
// Sensors that are not connected to the reference, or of which directions are open, come back with known = false and a
// diagnosis; of the latter the measured part, where `marginals` are asked for.
[[nodiscard]] GraphSolution Solve(const Graph& graph, const SolveOptions& options = {});

// T_A_B with its 6x6 covariance (right tangent at B) at a solution, by solving for the two sensors' columns only.
struct RelativePose {
  Se3 T_A_B;
  Matrix6d covariance = Matrix6d::Zero();
  // Directions that no edge measured, right tangent at B: there T_A_B is as it was held, and the covariance has
  // nothing.
  std::vector<Vector6d> unobservable_basis = {};
};
// Of sensors whose poses are known, whole or in part: two that are open in the same way may be known to each other.
// kNotFound if a sensor is not in the graph; kInvalidInput with a sentence if nothing is known of one, or A and B are
// not connected.
[[nodiscard]] Result<RelativePose> Relative(const Graph& graph, const GraphSolution& solution, const SensorId& a,
                                            const SensorId& b);

// Over all residuals; zero where there are none.
[[nodiscard]] GlobalError MeanSquares(const std::vector<Vector6d>& residuals);

// The order of sensors people expect: numeric names first, as numbers; then the others, letter by letter.
[[nodiscard]] bool SensorBefore(const SensorId& a, const SensorId& b);
// The graph of a robot's good edges. Reference: `reference` if not empty and present, else the first sensor by name
// (numeric names in numeric order).
[[nodiscard]] Graph GraphOf(const std::vector<Edge>& edges, const SensorId& reference);

}  // namespace rigcal::graph
