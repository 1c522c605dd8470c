// The honest covariance of a solution: a jackknife through the graph (design: correlated edges). Edges of one session
// share captures, so their errors are not independent and H^-1 is too small. Block i is taken out of every edge of its
// session at once (T_(i) = T Exp(d_i)); the optimum follows to first order, dx = K d, K = -H^-1 J^T Omega dr/dd. Weights
// are held: they hardly depend on the blocks (math/shrunk_scatter.h). Pure and deterministic: sessions, blocks and edges
// count in sorted order.
#pragma once

#include <map>

#include "server/graph/solve.h"
#include "server/model/edge.h"

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
[[nodiscard]] BlocksByEdge BlocksOf(const std::vector<Edge>& edges);

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
  std::vector<int> row_of_sensor;             // first row in `joint`; -1: the reference, or not known
  std::vector<bool> known;                    // the reference too
  Eigen::MatrixXd joint;                      // of all known sensors' poses, right tangents
  std::vector<double> dof;                    // behind a sensor's covariance (PooledDof); 0: nothing estimated
  std::vector<ResidualCovariance> residuals;  // in the order of GraphSolution::residuals
};
constexpr int kJackknifeSensorsMax = 500;

[[nodiscard]] GraphJackknife JackknifeGraph(const Graph& graph, const GraphSolution& solution,
                                            const BlocksByEdge& blocks);

// Zero for the reference. kNotFound if the sensor is not in the graph, kInvalidInput if its pose is not known.
[[nodiscard]] Result<Matrix6d> SensorCovariance(const GraphJackknife& jackknife, const SensorId& sensor);
// Of T_A_B with cross terms, right tangent at B, at the poses of `solution`.
[[nodiscard]] Result<RelativePose> RelativeByJackknife(const GraphJackknife& jackknife, const GraphSolution& solution,
                                                       const SensorId& a, const SensorId& b);
// Puts the jackknife's covariances and T^2 of the residuals into the solution; the analytic ones are kept beside them.
void ApplyJackknifeCovariance(const Graph& graph, const GraphJackknife& jackknife, GraphSolution& solution);

}  // namespace rigcal::graph
