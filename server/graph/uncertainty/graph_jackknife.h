// The honest covariance of a solution: a jackknife through the graph (design: correlated edges). Edges of one session
// share captures, so their errors are not independent and H^-1 is too small. Block i is taken out of every edge of its
// session at once (T_(i) = T Exp(d_i)); the optimum follows to first order, dx = K d, K = -H^-1 J^T Omega dr/dd.
// Weights are held: they hardly depend on the blocks (math/shrunk_scatter.h). Pure and deterministic: sessions, blocks
// and edges count in sorted order.
#pragma once

#include <map>

#include "server/graph/solve/linearize.h"
#include "server/graph/solve/solve.h"
#include "server/model/edges/edge.h"

namespace rigcal::graph {

// What is known beyond an edge's Omega.
struct EdgeBlocks {
  std::vector<BlockVector> blocks;
  Matrix6d C_given = Matrix6d::Zero();  // of given constants of its own; no block shows it, so it is added per edge
  std::map<std::string, std::vector<Vector6d>> shifts;  // of given constants that its session shares, by their name
  int dof = 0;                                          // of the edge's uncertainty
};
// Fewer blocks than this do not carry a covariance of six directions: such an edge counts with the C_e of its Omega.
constexpr std::size_t kJackknifeBlocksMin = 8;

// By edge, block ids unique. BlocksOf leaves out edges without enough block vectors, with a block twice, or with block
// vectors that do not scatter in every direction that the edge sees.
using BlocksByEdge = std::map<EdgeId, EdgeBlocks>;
// What a given constant brings goes to C_given where its shifts are not known or its name comes twice.
[[nodiscard]] BlocksByEdge BlocksOf(const std::vector<Edge>& edges);

// d of every block of a session (`ids`, sorted; the edge's own are among them), centred and scaled so that columns *
// columns^T is the jackknife's sum. A block that the edge does not have changes nothing in it.
[[nodiscard]] Eigen::MatrixXd CentredBlocks(const std::vector<BlockVector>& own, const std::vector<std::string>& ids);

struct ResidualCovariance {
  bool in_solution = false;
  Matrix6d C_e = Matrix6d::Zero();
  double dof = 0.0;  // Welch and Satterthwaite's, over sessions; 0: no estimated part
};

struct GraphJackknife {
  // False: no edge has kJackknifeBlocksMin blocks (the analytic covariance stands), or the graph has more than
  // kJackknifeSensorsMax sensors, or no solution to build on.
  bool available = false;
  std::vector<SensorId> sensors;              // as Graph::sensors
  std::vector<int> row_of_sensor;             // first row in `joint`; -1: the reference, or not placed
  std::vector<bool> placed;                   // known, whole or in part; the reference too
  Eigen::MatrixXd joint;                      // of all placed sensors' poses, right tangents; what is open is held
  std::vector<double> dof;                    // behind a sensor's covariance (PooledDof); 0: nothing estimated
  std::vector<ResidualCovariance> residuals;  // in the order of GraphSolution::residuals
};
constexpr int kJackknifeSensorsMax = 500;

// `solution`: of this graph, converged. Not available without blocks, with kJackknifeSensorsMax sensors or more beside
// the reference, and where H cannot be factored.
[[nodiscard]] GraphJackknife JackknifeGraph(const Graph& graph, const GraphSolution& solution,
                                            const BlocksByEdge& blocks);

// Zero for the reference. kNotFound if the sensor is not in the graph, kInvalidInput if nothing of its pose is known.
[[nodiscard]] Result<Matrix6d> SensorCovariance(const GraphJackknife& jackknife, const SensorId& sensor);
// Of T_A_B with cross terms, right tangent at B, at the poses of `solution`. `open`: what Relative says is open of it.
[[nodiscard]] Result<RelativePose> RelativeByJackknife(const GraphJackknife& jackknife, const GraphSolution& solution,
                                                       const SensorId& a, const SensorId& b,
                                                       const std::vector<Vector6d>& open = {});
// Puts the jackknife's covariances and T^2 of the residuals into the solution; the analytic ones are kept beside them.
void ApplyJackknifeCovariance(const Graph& graph, const GraphJackknife& jackknife, GraphSolution& solution);

// What makes the edges of a graph err: the blocks of each session, and each other edge by itself.

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

  // The edge behind a constraint, by its place in problem.constraints.
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

// T^2 of a residual by its covariance C, both whitened by what independent errors would leave. Directions with less
// than 1e-6 of that do not count: there nothing checks the residual, or shared causes cancel and it closes by
// construction.
struct CheckedDirections {
  int rank = 0;
  double t_squared = 0.0;
};
// `e` in the same coordinates as `C`, of which only the symmetric part counts.
[[nodiscard]] CheckedDirections CheckWhitened(const Matrix6d& C, const Vector6d& e);

}  // namespace rigcal::graph
