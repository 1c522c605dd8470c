// What the other edges say of each edge, at given poses and weights: for graphs small enough for a dense inverse.
#pragma once

#include "server/graph/solve/linearize.h"
#include "server/graph/solve/observability.h"

namespace rigcal::graph {

constexpr int kChecksSensorsMax = 300;

// Per constraint. `counts` false: the edge is held out (weight zero), the poses owe nothing to it.
struct EdgeCheck {
  EdgeJacobian jacobian;
  Matrix6d C_prediction = Matrix6d::Zero();  // J P J^T
  double t_squared = 0.0;                    // of e against its own covariance (that of a prediction without the edge)
  int rank = 0;                              // directions in which others check it
};

struct EdgeChecks {
  Eigen::MatrixXd P;  // of the free vertices' poses, right tangents
  std::vector<EdgeCheck> edges;
};

// `cholesky` holds the factor of H of the edges that count. Held-out edges are compared by C_edge + C_prediction,
// the others by C_edge - C_prediction (the same test as with the edge left out).
[[nodiscard]] EdgeChecks CheckEdges(const Problem& problem, const Poses& T_ref, const std::vector<bool>& counts,
                                    BlockCholesky<6>& cholesky);

// The optimum of the edges that agree: graduated non-convexity with truncated least squares (Yang et al. 2020,
// "Graduated Non-Convexity for Robust Spatial Perception"), then every edge tested against the others until the split
// stands.
struct RobustOptimum {
  bool available = false;
  Poses T_ref;
  std::vector<bool> kept;     // per constraint
  std::vector<double> limit;  // of T^2 per constraint; infinity: cannot be tested, always kept
  EdgeChecks checks;          // at T_ref, rejected edges held out
};

// `start`: the plain optimum. `dof` per constraint. Where all edges are good, all are kept with a probability of 0.999.
// Not available beyond kChecksSensorsMax sensors, or where the split does not come to rest.
[[nodiscard]] RobustOptimum OptimizeRobustly(const Problem& problem, const Poses& start, const std::vector<int>& dof);

}  // namespace rigcal::graph
