#include "tests/paper/global_experiment.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "client/sim/rig/random.h"
#include "server/base/process/parallel_for.h"
#include "server/graph/solve/problem.h"
#include "server/math/covariance.h"

namespace rigcal::paper {
namespace {

using Eigen::MatrixXd;

std::size_t TreeEdges(const Graph& graph) {
  std::size_t count = 0;
  for (const Matrix6d& weight : TreeWeights(graph)) count += weight.isZero(0) ? 0 : 1;
  return count;
}

// As the paper has it: one over each variance.
Graph WithDiagonalInformation(Graph graph) {
  for (GraphEdge& edge : graph.edges) {
    const Vector6d variances = Observable(edge.Omega).covariance.diagonal();
    edge.Omega = variances.cwiseInverse().asDiagonal();
  }
  return graph;
}

std::vector<Se3> TruthOf(const Graph& graph, const sim::Experiment& experiment) {
  std::vector<Se3> truth;
  for (const SensorId& sensor : graph.sensors) truth.push_back(experiment.T_ref_sensor(sensor));
  return truth;
}

GlobalSample SampleOf(const Graph& graph, const sim::Experiment& experiment) {
  const GraphSolution solution = graph::Solve(graph);
  GlobalSample sample{solution.before, solution.after, 0, 0, solution.cost, 0};
  std::map<SensorId, Se3> T_ref;
  for (const SensorPose& pose : solution.poses) {
    T_ref[pose.sensor] = pose.T_ref_sensor;
    const Vector6d e = (experiment.T_ref_sensor(pose.sensor).Inverse() * pose.T_ref_sensor).Log();
    sample.pose_m2 += e.head<3>().squaredNorm() / static_cast<double>(solution.poses.size() - 1);
    sample.pose_rad2 += e.tail<3>().squaredNorm() / static_cast<double>(solution.poses.size() - 1);
  }
  double measured = 0, solved = 0;
  for (const GraphEdge& edge : graph.edges) {
    const Se3 T_b_a_true = paper::TruthOf(experiment, edge.frame_b, edge.frame_a);
    const Vector6d e = (T_b_a_true * edge.T_a_b).Log();
    const Vector6d e_solved = (T_b_a_true * T_ref.at(edge.frame_a).Inverse() * T_ref.at(edge.frame_b)).Log();
    measured += e.dot(edge.Omega * e);
    solved += e_solved.dot(edge.Omega * e_solved);
  }
  sample.whitened_ratio = solved / measured;
  return sample;
}

// Mean squares of the translations and of the rotations among rows of sixes.
std::pair<double, double> MeanSquares(const MatrixXd& columns) {
  double translation_m2 = 0, rotation_rad2 = 0;
  for (Eigen::Index row = 0; row < columns.rows(); row += 6) {
    translation_m2 += columns.middleRows<3>(row).squaredNorm();
    rotation_rad2 += columns.middleRows<3>(row + 3).squaredNorm();
  }
  const double count = static_cast<double>(columns.rows()) / 6;
  return {translation_m2 / count, rotation_rad2 / count};
}

Status CheckConnected(const Graph& graph, const Visit& visit) {
  if (graph.sensors.size() == visit.experiment.rig.sensors.size() && graph::MakeProblem(graph).diagnoses.empty() &&
      TreeEdges(graph) + 1 == graph.sensors.size())
    return {};
  return Fail(ErrorCode::kInvalidInput,
              "visit " + std::to_string(visit.experiment.options.seed) + " left sensors without a calibration",
              "Give more captures.");
}

struct Prediction {
  Spread before, after;  // of the sum over the edges
  double pose_m2 = 0.0, pose_rad2 = 0.0;
};

Prediction Predict(const Graph& graph, const std::vector<Se3>& truth, const MatrixXd& columns) {
  const LinearGraph linear(graph, truth);
  const auto [pose_m2, pose_rad2] = MeanSquares(linear.Gain(WeightsOf(graph)) * columns);
  return {SpreadOf(linear.ResidualMap(TreeWeights(graph)) * columns),
          SpreadOf(linear.ResidualMap(WeightsOf(graph)) * columns), pose_m2, pose_rad2};
}

// `part`: of the run's samples that the prediction is for, `samples` of them. `known_dof`: behind its columns.
void AddPrediction(const Prediction& prediction, std::size_t edges, double part, double samples, double known_dof,
                   GlobalRun& run) {
  run.predicted_before += part * prediction.before.mean / static_cast<double>(edges);
  run.predicted_after += part * prediction.after.mean / static_cast<double>(edges);
  run.predicted_pose_m2 += part * prediction.pose_m2;
  run.predicted_pose_rad2 += part * prediction.pose_rad2;
  const double variance = part * part * 2 * (1 / samples + 1 / known_dof);
  run.variance_before_ratio += variance / prediction.before.dof;
  run.variance_after_ratio += variance / prediction.after.dof;
}

void AddVisit(const Visit& visit, const Graph& graph, const std::vector<Edge>& edges, double part, GlobalRun& run) {
  run.samples.push_back(SampleOf(graph, visit.experiment));
  const double blocks = static_cast<double>(visit.experiment.captures.size());
  AddPrediction(Predict(graph, TruthOf(graph, visit.experiment), ErrorColumns(edges)), edges.size(), part, 1,
                blocks - 1, run);
}

Graph WithErrors(Graph graph, const sim::Experiment& experiment, const MatrixXd& columns, std::uint64_t key) {
  sim::Random random(key);
  Eigen::VectorXd z(columns.cols());
  for (Eigen::Index i = 0; i < z.size(); ++i) z[i] = random.Normal();
  const Eigen::VectorXd d = columns * z;
  for (std::size_t k = 0; k < graph.edges.size(); ++k) {
    GraphEdge& edge = graph.edges[k];
    edge.T_a_b = (paper::TruthOf(experiment, edge.frame_a, edge.frame_b) *
                  Se3::Exp(d.segment<6>(6 * static_cast<Eigen::Index>(k))))
                     .Normalized();
  }
  return graph;
}

// The errors, and what is said of them, `factor` times as large.
GlobalRuns Draw(Graph graph, const sim::Experiment& experiment, double factor, int draws, std::uint64_t seed) {
  for (GraphEdge& edge : graph.edges) edge.Omega /= factor * factor;
  const Graph diagonal = WithDiagonalInformation(graph);
  const MatrixXd columns = IndependentColumns(graph);
  GlobalRuns runs;
  runs.full.samples.resize(static_cast<std::size_t>(draws));
  runs.diagonal.samples.resize(static_cast<std::size_t>(draws));
  ParallelFor(static_cast<std::size_t>(draws), [&](std::size_t i) {
    const std::uint64_t key = sim::KeyOf(seed, "edge errors", {}, i);
    runs.full.samples[i] = SampleOf(WithErrors(graph, experiment, columns, key), experiment);
    runs.diagonal.samples[i] = SampleOf(WithErrors(diagonal, experiment, columns, key), experiment);
  });
  const std::vector<Se3> truth = TruthOf(graph, experiment);
  constexpr double kKnown = 1e9;
  AddPrediction(Predict(graph, truth, columns), graph.edges.size(), 1, draws, kKnown, runs.full);
  AddPrediction(Predict(diagonal, truth, columns), graph.edges.size(), 1, draws, kKnown, runs.diagonal);
  return runs;
}

}  // namespace

GlobalSample GlobalRun::Mean() const {
  GlobalSample mean;
  const double part = 1.0 / static_cast<double>(samples.size());
  for (const GlobalSample& sample : samples) {
    mean.before.total += part * sample.before.total;
    mean.after.total += part * sample.after.total;
    mean.pose_m2 += part * sample.pose_m2;
    mean.pose_rad2 += part * sample.pose_rad2;
    mean.cost += part * sample.cost;
    mean.whitened_ratio += part * sample.whitened_ratio;
  }
  return mean;
}

double GlobalExperiment::WhitenedExpected() const {
  const double kept = 6.0 * static_cast<double>(sensors - 1);
  return kept / (kept + dof);
}

double GlobalExperiment::WhitenedHalfWidth() const {
  constexpr double kSigmas = 4.9;  // of a normal mean
  const double kept = WhitenedExpected(), all = 6.0 * static_cast<double>(sensors - 1) + dof;
  return kSigmas * std::sqrt(kept * (1 - kept) / (all / 2 + 1) / draws);
}

Result<GlobalExperiment> RunGlobalExperiment(const std::vector<Visit>& visits, int draws, std::uint64_t seed) {
  GlobalExperiment experiment;
  experiment.edges_min = visits.front().edges.size();
  for (const Visit& visit : visits) {
    const std::vector<Edge> edges = GoodEdges(visit);
    const Graph graph = graph::GraphOf(edges, visit.experiment.rig.reference);
    RIGCAL_TRY(CheckConnected(graph, visit));
    const double part = 1.0 / static_cast<double>(visits.size());
    AddVisit(visit, graph, edges, part, experiment.visits.full);
    AddVisit(visit, WithDiagonalInformation(graph), edges, part, experiment.visits.diagonal);
    experiment.edges_min = std::min(experiment.edges_min, edges.size());
  }
  const sim::Experiment& first = visits.front().experiment;
  Graph graph = graph::GraphOf(GoodEdges(visits.front()), first.rig.reference);
  experiment.sensors = graph.sensors.size();
  experiment.captures = first.captures.size();
  experiment.draws = draws;
  experiment.realistic = Draw(graph, first, 1, draws, seed);
  experiment.noise_factor = std::sqrt(kPaperBefore / experiment.realistic.full.predicted_before);
  experiment.paper = Draw(graph, first, experiment.noise_factor, draws, seed);
  experiment.dof = graph::Solve(graph).dof;
  const auto [edge_m2, edge_rad2] = MeanSquares(IndependentColumns(graph));
  experiment.edge_rms_m = std::sqrt(edge_m2);
  experiment.edge_rms_rad = std::sqrt(edge_rad2);
  return experiment;
}

}  // namespace rigcal::paper
