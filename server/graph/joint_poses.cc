#include "server/graph/joint_poses.h"

#include <algorithm>

#include "server/graph/observability.h"
#include "server/graph/start_poses.h"
#include "server/math/covariance.h"

namespace rigcal::graph {
namespace {

constexpr int kOfReference = -1, kNone = -2;

// Edges taken as independent: H^-1, of the known sensors in the order of `sensors`.
std::optional<JointCovariance> AnalyticJoint(const Graph& graph, const GraphSolution& solution,
                                             const std::vector<SensorId>& sensors) {
  const Problem problem = MakeProblem(graph);
  const auto cholesky = FactorAt(problem, SolvedPoses(graph, problem, solution));
  if (cholesky == nullptr) return std::nullopt;
  const auto rows = static_cast<Eigen::Index>(6 * sensors.size());
  Eigen::MatrixXd columns = Eigen::MatrixXd::Zero(6 * problem.free_count(), rows);
  std::vector<Eigen::Index> row_of;
  for (const SensorId& sensor : sensors) {
    const auto found = std::find(graph.sensors.begin(), graph.sensors.end(), sensor);
    const int vertex = found == graph.sensors.end() ? -1 : problem.vertex_of_sensor[static_cast<std::size_t>(found - graph.sensors.begin())];
    if (vertex <= 0) return std::nullopt;
    columns.block<6, 6>(6 * (vertex - 1), static_cast<Eigen::Index>(6 * row_of.size())).setIdentity();
    row_of.push_back(6 * (vertex - 1));
  }
  cholesky->SolveInPlace(columns);
  JointCovariance joint{sensors, Eigen::MatrixXd(rows, rows)};
  for (std::size_t k = 0; k < sensors.size(); ++k)
    joint.matrix.middleRows<6>(static_cast<Eigen::Index>(6 * k)) = columns.middleRows<6>(row_of[k]);
  return joint.matrix.allFinite() ? std::optional(std::move(joint)) : std::nullopt;
}

std::optional<JointCovariance> JackknifeJoint(const GraphJackknife& jackknife, const std::vector<SensorId>& sensors) {
  JointCovariance joint{sensors, Eigen::MatrixXd(6 * sensors.size(), 6 * sensors.size())};
  std::vector<int> row_of;
  for (const SensorId& sensor : sensors) {
    const auto found = std::find(jackknife.sensors.begin(), jackknife.sensors.end(), sensor);
    row_of.push_back(found == jackknife.sensors.end() ? -1
                                                      : jackknife.row_of_sensor[static_cast<std::size_t>(found - jackknife.sensors.begin())]);
    if (row_of.back() < 0) return std::nullopt;
  }
  for (std::size_t i = 0; i < sensors.size(); ++i)
    for (std::size_t k = 0; k < sensors.size(); ++k)
      joint.matrix.block<6, 6>(static_cast<Eigen::Index>(6 * i), static_cast<Eigen::Index>(6 * k)) =
          jackknife.joint.block<6, 6>(row_of[i], row_of[k]);
  return joint;
}

int RowOf(const JointPoses& poses, const JointCovariance& covariance, const SensorId& sensor) {
  if (sensor == poses.reference) return kOfReference;
  const auto found = std::find(covariance.sensors.begin(), covariance.sensors.end(), sensor);
  return found == covariance.sensors.end() ? kNone : 6 * static_cast<int>(found - covariance.sensors.begin());
}

}  // namespace

JointPoses FusedPosesOf(const GraphSolution& solution, const SensorId& reference) {
  JointPoses joint{reference, {}, {}};
  for (const SensorPose& pose : solution.poses)
    if (pose.known) joint.T_ref_sensor.emplace(pose.sensor, pose.T_ref_sensor);
  if (!solution.fused.sensors.empty()) joint.covariances.push_back({solution.fused.sensors, solution.fused.covariance});
  return joint;
}

JointPoses JointPosesOf(const Graph& graph, const GraphSolution& solution, const GraphJackknife& jackknife) {
  JointPoses joint = FusedPosesOf(solution, graph.reference);
  std::vector<SensorId> sensors;
  for (const auto& [sensor, T_ref_sensor] : joint.T_ref_sensor)
    if (sensor != graph.reference) sensors.push_back(sensor);
  if (sensors.size() > kJointPosesMax) joint.covariances.clear();
  if (solution.fused.sensors.size() >= sensors.size() || sensors.size() > kJointPosesMax) return joint;
  auto of_graph = jackknife.available ? JackknifeJoint(jackknife, sensors) : AnalyticJoint(graph, solution, sensors);
  if (of_graph) joint.covariances.push_back(std::move(*of_graph));
  return joint;
}

std::optional<RelativePose> RelativeOf(const JointPoses& poses, const SensorId& a, const SensorId& b) {
  const auto of_a = poses.T_ref_sensor.find(a), of_b = poses.T_ref_sensor.find(b);
  if (of_a == poses.T_ref_sensor.end() || of_b == poses.T_ref_sensor.end()) return std::nullopt;
  if (a == b) return RelativePose{};
  for (const JointCovariance& covariance : poses.covariances) {
    const int row_a = RowOf(poses, covariance, a), row_b = RowOf(poses, covariance, b);
    if (row_a == kNone || row_b == kNone) continue;
    const auto block = [&](int row, int column) -> Matrix6d {
      return row < 0 || column < 0 ? Matrix6d(Matrix6d::Zero()) : Matrix6d(covariance.matrix.block<6, 6>(row, column));
    };
    RelativePose relative;
    relative.T_A_B = (of_a->second.Inverse() * of_b->second).Normalized();
    relative.covariance = RelativeCovariance(relative.T_A_B, block(row_a, row_a), block(row_b, row_b), block(row_a, row_b));
    return relative;
  }
  return std::nullopt;
}

}  // namespace rigcal::graph
