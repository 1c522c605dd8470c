// What the other edges say of each edge, at given poses and weights: for graphs small enough for a dense inverse.
#pragma once

#include "server/graph/linearize.h"
#include "server/graph/observability.h"

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

}  // namespace rigcal::graph
