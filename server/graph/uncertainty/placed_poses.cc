#include "server/graph/uncertainty/placed_poses.h"

#include <algorithm>

#include "server/graph/solve/observability.h"
#include "server/graph/solve/start_poses.h"
#include "server/graph/uncertainty/joint_poses.h"
#include "server/math/covariance.h"

namespace rigcal::graph {
namespace {

using Eigen::Index;

constexpr Index kReference = -1, kNowhere = -2;

bool IsKnownInPart(const SensorPose& pose) { return !pose.known && pose.Placed() != nullptr; }

int VertexOf(const Graph& graph, const Problem& problem, const SensorId& sensor) {
  const auto found = std::find(graph.sensors.begin(), graph.sensors.end(), sensor);
  return found == graph.sensors.end()
             ? -1
             : problem.vertex_of_sensor[static_cast<std::size_t>(found - graph.sensors.begin())];
}

// Of the sensors, at the vertices.
void TakeFree(const Observability& open, const std::vector<int>& vertices, PlacedPoses& placed) {
  placed.scale = open.scale, placed.visible = open.visible;
  const Index columns = open.motion_of_vertex.empty() ? 0 : open.motion_of_vertex.front().cols();
  placed.motions = Eigen::MatrixXd::Zero(static_cast<Index>(6 * vertices.size()), columns);
  if (columns == 0) return;
  for (std::size_t k = 0; k < vertices.size(); ++k)
    placed.motions.middleRows<6>(static_cast<Index>(6 * k)) =
        open.motion_of_vertex[static_cast<std::size_t>(vertices[k])];
}

Index RowOf(const PlacedPoses& poses, const SensorId& sensor) {
  if (sensor == poses.reference) return kReference;
  const auto found = std::find(poses.sensors.begin(), poses.sensors.end(), sensor);
  return found == poses.sensors.end() ? kNowhere : 6 * (found - poses.sensors.begin());
}

Se3 PlaceAt(const PlacedPoses& poses, Index row) {
  return row == kReference ? Se3() : poses.T_ref_sensor[static_cast<std::size_t>(row / 6)];
}

Matrix6d CovarianceAt(const PlacedPoses& poses, Index row, Index column) {
  if (row == kReference || column == kReference) return Matrix6d::Zero();
  return poses.covariance.block<6, 6>(row, column);
}

FreeBasis MotionAt(const PlacedPoses& poses, Index row) {
  if (row == kReference) return FreeBasis::Zero(6, poses.motions.cols());
  return poses.motions.middleRows<6>(row);
}

// What of the motions of the two moves them against each other.
FreeBasis OpenBetween(const PlacedPoses& poses, Index row_a, Index row_b, const Se3& T_a_b) {
  Observability open;
  open.scale = poses.scale, open.visible = poses.visible;
  if (poses.motions.cols() > 0) open.motion_of_vertex = {MotionAt(poses, row_a), MotionAt(poses, row_b)};
  return Reduced(FreeBetween(open, 0, 1, T_a_b));
}

}  // namespace

GraphSolution WithPosesByPairs(GraphSolution solution) {
  for (SensorPose& pose : solution.poses)
    if (pose.fused) pose.T_ref_sensor = pose.fused->T_ref_sensor_by_pairs;
  return solution;
}

std::optional<PlacedPoses> PlacedPosesOf(const Graph& graph, const GraphSolution& solution,
                                         const GraphJackknife& jackknife) {
  if (std::none_of(solution.poses.begin(), solution.poses.end(), IsKnownInPart)) return std::nullopt;
  const GraphSolution by_pairs = WithPosesByPairs(solution);
  const Problem problem = MakeProblem(graph);
  PlacedPoses placed;
  placed.reference = graph.reference;
  std::vector<int> vertices;
  for (const SensorPose& pose : by_pairs.poses) {
    const int vertex = pose.Placed() != nullptr ? VertexOf(graph, problem, pose.sensor) : -1;
    if (vertex <= 0) continue;  // the reference, or nowhere
    placed.sensors.push_back(pose.sensor);
    placed.T_ref_sensor.push_back(*pose.Placed());
    vertices.push_back(vertex);
  }
  if (placed.sensors.empty() || placed.sensors.size() > kJointPosesMax) return std::nullopt;
  auto joint = JointOfGraph(graph, by_pairs, jackknife, placed.sensors);
  if (!joint) return std::nullopt;
  placed.covariance = std::move(joint->matrix);
  TakeFree(Observe(problem, SolvedPoses(graph, problem, by_pairs)), vertices, placed);
  return placed;
}

std::optional<RelativePose> RelativeOf(const PlacedPoses& poses, const SensorId& a, const SensorId& b) {
  const Index row_a = RowOf(poses, a), row_b = RowOf(poses, b);
  if (row_a == kNowhere || row_b == kNowhere) return std::nullopt;
  RelativePose relative;
  if (a == b) return relative;
  relative.T_A_B = (PlaceAt(poses, row_a).Inverse() * PlaceAt(poses, row_b)).Normalized();
  const FreeBasis open = OpenBetween(poses, row_a, row_b, relative.T_A_B);
  relative.covariance =
      CovarianceAcross(RelativeCovariance(relative.T_A_B, CovarianceAt(poses, row_a, row_a),
                                          CovarianceAt(poses, row_b, row_b), CovarianceAt(poses, row_a, row_b)),
                       open);
  relative.unobservable_basis = ColumnsOf(open);
  return relative;
}

}  // namespace rigcal::graph
