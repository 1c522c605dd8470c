// What makes the edges of a graph err: the blocks of each session, and each other edge by itself.
#pragma once

#include <algorithm>
#include <optional>

#include "server/graph/edge_jacobian.h"
#include "server/graph/graph_jackknife.h"

namespace rigcal::graph {

// Blocks that made Omega as well as they move the measurement.
struct WeightBlocks {
  Eigen::MatrixXd d;  // one column per block of the session, right tangents at the edge's b; d d^T is their covariance
  std::vector<char> own;  // whether the edge has that block
  double share = 0.0;     // of the blocks in the edge's covariance
};

// Changes of one constraint's residual, one column per independent cause.
struct ErrorPart {
  std::size_t constraint = 0;
  Eigen::MatrixXd de;
  std::optional<WeightBlocks> weight;
};

// Causes that are estimated together: the blocks of a session, or one edge's own error. C of it is
// (columns)(columns)^T.
struct ErrorSource {
  int dof = 0;             // 0: known
  bool of_blocks = false;  // a column per block
  Eigen::Index column_count = 0;
  std::vector<ErrorPart> parts;

  [[nodiscard]] bool HasWeight() const {
    return std::any_of(parts.begin(), parts.end(), [](const ErrorPart& part) { return part.weight.has_value(); });
  }
};
// By which d_i is multiplied so that the jackknife's sum over m blocks is the sum of squares.
[[nodiscard]] double BlockScale(Eigen::Index m);

struct JackknifeWork {
  const Graph& graph;
  const Problem& problem;
  const BlocksByEdge& blocks;
  std::vector<EdgeJacobian> jacobians;  // by constraint

  [[nodiscard]] const GraphEdge& EdgeOf(std::size_t constraint) const {
    return graph.edges[problem.edges_by_id[problem.constraints[constraint].edge]];
  }
};

// Whether any edge that takes part has blocks enough.
[[nodiscard]] bool AnySession(const JackknifeWork& work);
// Sessions by id, then edges by id.
[[nodiscard]] std::vector<ErrorSource> SourcesOf(const JackknifeWork& work);
// The two kinds apart: causes that edges of a session share, and what one edge alone errs by (no columns: nothing).
[[nodiscard]] std::vector<ErrorSource> SharedSourcesOf(const JackknifeWork& work);
[[nodiscard]] ErrorSource OwnSourceOf(const JackknifeWork& work, std::size_t constraint);

// Without block i Omega is another, Omega_(i): Omega (r + pull) = Omega_(i) r, per column of residuals r.
[[nodiscard]] Eigen::MatrixXd PullByWeight(const WeightBlocks& weight, const Matrix6d& Omega,
                                           const Eigen::MatrixXd& residuals);

}  // namespace rigcal::graph
