// What makes the edges of a graph err: the blocks of each session, and each other edge by itself.
#pragma once

#include "server/graph/graph_jackknife.h"
#include "server/graph/linearize.h"

namespace rigcal::graph {

// Changes of one constraint's residual, one column per independent cause.
struct ErrorPart {
  std::size_t constraint = 0;
  Eigen::MatrixXd de;
};

// Causes that are estimated together: the blocks of a session, or one edge's own error. C of it is
// (columns)(columns)^T.
struct ErrorSource {
  int dof = 0;             // 0: known
  bool of_blocks = false;  // a column per block
  Eigen::Index column_count = 0;
  std::vector<ErrorPart> parts;
};

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

// T^2 of a residual by its covariance C, both whitened by what independent errors would leave. Directions with less than
// 1e-6 of that do not count: there nothing checks the residual, or shared causes cancel and it closes by construction.
struct CheckedDirections {
  int rank = 0;
  double t_squared = 0.0;
};
[[nodiscard]] CheckedDirections CheckWhitened(const Matrix6d& C, const Vector6d& e);

}  // namespace rigcal::graph
