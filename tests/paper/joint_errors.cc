#include "tests/paper/joint_errors.h"

#include <Eigen/Cholesky>
#include <algorithm>

#include "server/graph/solve/start_poses.h"
#include "server/graph/uncertainty/graph_jackknife.h"
#include "server/math/covariance.h"
#include "server/math/statistics.h"

namespace rigcal::paper {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;

constexpr double kFalseAlarm = 1e-6;
constexpr double kOnTree = 1e-10;  // residual of an edge that the start was composed of

Index RowOf(std::size_t edge) { return 6 * static_cast<Index>(edge); }

// Its place in the graph's edges.
std::size_t EdgeOf(const graph::Problem& problem, std::size_t constraint) {
  return problem.edges_by_id[problem.constraints[constraint].edge];
}

std::size_t SensorIndex(const Graph& graph, const SensorId& id) {
  return static_cast<std::size_t>(std::find(graph.sensors.begin(), graph.sensors.end(), id) - graph.sensors.begin());
}

}  // namespace

MatrixXd ErrorColumns(const std::vector<Edge>& edges) {
  const Graph graph = graph::GraphOf(edges, SensorId());
  const graph::Problem problem = graph::MakeProblem(graph);
  const graph::BlocksByEdge blocks = graph::BlocksOf(edges);
  graph::JackknifeWork work{graph, problem, blocks, {}};
  graph::EdgeJacobian own;
  own.D = Matrix6d::Identity();
  work.jacobians.assign(problem.constraints.size(), own);
  const std::vector<graph::ErrorSource> sources = graph::SourcesOf(work);
  Index count = 0, at = 0;
  for (const graph::ErrorSource& source : sources) count += source.column_count;
  MatrixXd columns = MatrixXd::Zero(RowOf(edges.size()), count);
  for (const graph::ErrorSource& source : sources) {
    for (const graph::ErrorPart& part : source.parts)
      columns.block(RowOf(EdgeOf(problem, part.constraint)), at, 6, source.column_count) += part.de;
    at += source.column_count;
  }
  return columns;
}

MatrixXd IndependentColumns(const Graph& graph) {
  MatrixXd columns = MatrixXd::Zero(RowOf(graph.edges.size()), RowOf(graph.edges.size()));
  for (std::size_t k = 0; k < graph.edges.size(); ++k)
    columns.block<6, 6>(RowOf(k), RowOf(k)) = SquareRoot(Observable(graph.edges[k].Omega).covariance);
  return columns;
}

LinearGraph::LinearGraph(const Graph& graph, const std::vector<Se3>& truth) {
  J = MatrixXd::Zero(RowOf(graph.edges.size()), RowOf(graph.sensors.size() - 1));
  const std::size_t reference = SensorIndex(graph, graph.reference);
  const auto column = [&](std::size_t sensor) { return RowOf(sensor < reference ? sensor : sensor - 1); };
  for (std::size_t k = 0; k < graph.edges.size(); ++k) {
    const std::size_t i = SensorIndex(graph, graph.edges[k].frame_a), j = SensorIndex(graph, graph.edges[k].frame_b);
    if (i != reference) J.block<6, 6>(RowOf(k), column(i)) = -Adjoint(truth[j].Inverse() * truth[i]);
    if (j != reference) J.block<6, 6>(RowOf(k), column(j)) = Matrix6d::Identity();
  }
}

MatrixXd LinearGraph::Gain(const std::vector<Matrix6d>& weights) const {
  MatrixXd JtW(J.cols(), J.rows());
  for (std::size_t k = 0; k < weights.size(); ++k)
    JtW.middleCols<6>(RowOf(k)) = J.middleRows<6>(RowOf(k)).transpose() * weights[k];
  const MatrixXd H = JtW * J;
  const Eigen::VectorXd scale = H.diagonal().cwiseSqrt().cwiseInverse();
  const Eigen::LDLT<MatrixXd> solver(scale.asDiagonal() * H * scale.asDiagonal());
  return scale.asDiagonal() * solver.solve(MatrixXd(scale.asDiagonal() * JtW));
}

MatrixXd LinearGraph::ResidualMap(const std::vector<Matrix6d>& weights) const {
  return J * Gain(weights) - MatrixXd::Identity(J.rows(), J.rows());
}

std::vector<Matrix6d> WeightsOf(const Graph& graph) {
  std::vector<Matrix6d> weights;
  for (const GraphEdge& edge : graph.edges) weights.push_back(edge.Omega);
  return weights;
}

std::vector<Matrix6d> TreeWeights(const Graph& graph) {
  const graph::Problem problem = graph::MakeProblem(graph);
  const graph::Poses T_ref = graph::SpanningTreePoses(problem);
  std::vector<Matrix6d> weights(graph.edges.size(), Matrix6d::Zero());
  for (std::size_t k = 0; k < problem.constraints.size(); ++k)
    if (graph::Residual(problem.constraints[k], T_ref).norm() < kOnTree)
      weights[EdgeOf(problem, k)] = problem.constraints[k].Omega;
  return weights;
}

Spread SpreadOf(const MatrixXd& columns) {
  const MatrixXd gram = columns.transpose() * columns;
  const double mean = gram.trace();
  return {mean, mean * mean / gram.squaredNorm()};
}

Interval IntervalOf(double dof) {
  return {ChiSquareQuantile(kFalseAlarm / 2, dof) / dof, ChiSquareQuantile(1 - kFalseAlarm / 2, dof) / dof};
}

}  // namespace rigcal::paper
