#include "server/graph/uncertainty/joint_poses.h"

#include <algorithm>
#include <set>
#include <span>

#include "server/graph/solve/observability.h"
#include "server/graph/solve/start_poses.h"
#include "server/math/covariance.h"

namespace rigcal::graph {
namespace {

using Eigen::MatrixXd;

constexpr int kOfReference = -1, kNone = -2;

// -1: it is not there.
int IndexOf(const std::vector<SensorId>& sensors, const SensorId& sensor) {
  const auto found = std::find(sensors.begin(), sensors.end(), sensor);
  return found == sensors.end() ? -1 : static_cast<int>(found - sensors.begin());
}

Result<std::size_t> FindSensor(const Graph& graph, const SensorId& sensor) {
  const int index = IndexOf(graph.sensors, sensor);
  if (index < 0)
    return Fail(ErrorCode::kNotFound, "sensor " + sensor.str() + " is not in the graph",
                "Check the name; the robot's report lists its sensors.");
  return static_cast<std::size_t>(index);
}

Result<const Se3*> FindPlaced(const Graph& graph, const GraphSolution& solution, std::size_t sensor) {
  const SensorId& id = graph.sensors[sensor];
  const auto pose = std::find_if(solution.poses.begin(), solution.poses.end(),
                                 [&id](const SensorPose& candidate) { return candidate.sensor == id; });
  if (pose != solution.poses.end() && pose->Placed() != nullptr) return pose->Placed();
  const std::string prefix = "sensor " + id.str() + " ";
  const auto why = std::find_if(solution.diagnoses.begin(), solution.diagnoses.end(),
                                [&prefix](const Diagnosis& d) { return d.what.find(prefix) != std::string::npos; });
  if (why != solution.diagnoses.end()) return Fail(ErrorCode::kInvalidInput, why->what, why->cure);
  return Fail(ErrorCode::kInvalidInput, "the pose of sensor " + id.str() + " is not known in this solution",
              "Add an edge that connects it with " + graph.reference.str() + ".");
}

// Columns of H^-1, six per vertex; the reference's are zero. Nothing where H cannot be factored.
std::optional<MatrixXd> InverseColumns(const Problem& problem, const Poses& T_ref, const std::vector<int>& vertices) {
  const auto cholesky = FactorAt(problem, T_ref);
  if (cholesky == nullptr) return std::nullopt;
  MatrixXd columns = MatrixXd::Zero(6 * problem.free_count(), static_cast<Eigen::Index>(6 * vertices.size()));
  for (std::size_t k = 0; k < vertices.size(); ++k)
    if (vertices[k] > 0) columns.block<6, 6>(6 * (vertices[k] - 1), static_cast<Eigen::Index>(6 * k)).setIdentity();
  cholesky->SolveInPlace(columns);
  return columns;
}

RelativePose RelativeBetween(const Se3& T_ref_A, const Se3& T_ref_B, const Matrix6d& C_AA, const Matrix6d& C_BB,
                             const Matrix6d& C_AB) {
  const Se3 T_A_B = (T_ref_A.Inverse() * T_ref_B).Normalized();
  return {T_A_B, RelativeCovariance(T_A_B, C_AA, C_BB, C_AB)};
}

// Edges taken as independent: H^-1, of the known sensors in the order of `sensors`.
std::optional<JointCovariance> AnalyticJoint(const Graph& graph, const GraphSolution& solution,
                                             const std::vector<SensorId>& sensors) {
  const Problem problem = MakeProblem(graph);
  std::vector<int> vertices;
  for (const SensorId& sensor : sensors) {
    const int index = IndexOf(graph.sensors, sensor);
    vertices.push_back(index < 0 ? -1 : problem.vertex_of_sensor[static_cast<std::size_t>(index)]);
    if (vertices.back() <= 0) return std::nullopt;
  }
  const auto columns = InverseColumns(problem, SolvedPoses(graph, problem, solution), vertices);
  if (!columns) return std::nullopt;
  JointCovariance joint{sensors, MatrixXd(columns->cols(), columns->cols())};
  for (std::size_t k = 0; k < sensors.size(); ++k)
    joint.matrix.middleRows<6>(static_cast<Eigen::Index>(6 * k)) = columns->middleRows<6>(6 * (vertices[k] - 1));
  return joint.matrix.allFinite() ? std::optional(std::move(joint)) : std::nullopt;
}

std::optional<JointCovariance> JackknifeJoint(const GraphJackknife& jackknife, const std::vector<SensorId>& sensors) {
  JointCovariance joint{sensors, MatrixXd(6 * sensors.size(), 6 * sensors.size())};
  std::vector<int> row_of;
  for (const SensorId& sensor : sensors) {
    const int index = IndexOf(jackknife.sensors, sensor);
    row_of.push_back(index < 0 ? -1 : jackknife.row_of_sensor[static_cast<std::size_t>(index)]);
    if (row_of.back() < 0) return std::nullopt;
  }
  for (std::size_t i = 0; i < sensors.size(); ++i)
    for (std::size_t k = 0; k < sensors.size(); ++k)
      joint.matrix.block<6, 6>(static_cast<Eigen::Index>(6 * i), static_cast<Eigen::Index>(6 * k)) =
          jackknife.joint.block<6, 6>(row_of[i], row_of[k]);
  return joint;
}

// Of those of the pairs' sensors that are known; the reference needs no rows.
std::vector<JointCovariance> JointsOfPairs(std::span<const SensorPair> pairs, const Graph& graph,
                                           const GraphSolution& solution, const GraphJackknife& jackknife) {
  JointPoses joint = FusedPosesOf(solution, graph.reference);
  std::set<SensorId> sensors;
  for (const SensorPair& pair : pairs)
    for (const SensorId& sensor : {pair.a, pair.b})
      if (sensor != graph.reference && joint.T_ref_sensor.contains(sensor)) sensors.insert(sensor);
  if (sensors.empty()) return {};
  auto of_graph = JointOfGraph(graph, solution, jackknife, {sensors.begin(), sensors.end()});
  if (of_graph) joint.covariances.push_back(std::move(*of_graph));
  return std::move(joint.covariances);
}

int RowOf(const JointPoses& poses, const JointCovariance& covariance, const SensorId& sensor) {
  if (sensor == poses.reference) return kOfReference;
  const int index = IndexOf(covariance.sensors, sensor);
  return index < 0 ? kNone : 6 * index;
}

}  // namespace

Result<RelativePose> Relative(const Graph& graph, const GraphSolution& solution, const SensorId& a, const SensorId& b) {
  RIGCAL_ASSIGN(const std::size_t sensor_a, FindSensor(graph, a));
  RIGCAL_ASSIGN(const std::size_t sensor_b, FindSensor(graph, b));
  RIGCAL_ASSIGN(const Se3* T_ref_a, FindPlaced(graph, solution, sensor_a));
  RIGCAL_ASSIGN(const Se3* T_ref_b, FindPlaced(graph, solution, sensor_b));
  if (a == b) return RelativePose{};
  const Problem problem = MakeProblem(graph);
  const int vertex_a = problem.vertex_of_sensor[sensor_a], vertex_b = problem.vertex_of_sensor[sensor_b];
  if (vertex_a < 0 || vertex_b < 0)
    return Fail(ErrorCode::kInvalidInput, "sensors " + a.str() + " and " + b.str() + " are not connected in this graph",
                "Solve the graph again with the edges that it has now.");
  const Poses T_ref = SolvedPoses(graph, problem, solution);
  const auto columns = InverseColumns(problem, T_ref, {vertex_a, vertex_b});
  if (!columns)
    return Fail(
        ErrorCode::kInvalidInput,
        "the uncertainty between these sensors cannot be computed: the graph is too large, or the information of "
        "its edges spans too many orders of magnitude",
        "Check the information matrices of the edges for wrong units (metres and radians).");
  const auto block = [&columns](int vertex, int of) -> Matrix6d {
    return vertex > 0 ? Matrix6d(columns->block<6, 6>(6 * (vertex - 1), 6 * of)) : Matrix6d(Matrix6d::Zero());
  };
  RelativePose relative =
      RelativeBetween(*T_ref_a, *T_ref_b, block(vertex_a, 0), block(vertex_b, 1), block(vertex_a, 1));
  const FreeBasis open = Reduced(FreeBetween(Observe(problem, T_ref), vertex_a, vertex_b, relative.T_A_B));
  relative.covariance = CovarianceAcross(relative.covariance, open);
  relative.unobservable_basis = ColumnsOf(open);
  return relative;
}

std::optional<JointCovariance> JointOfGraph(const Graph& graph, const GraphSolution& solution,
                                            const GraphJackknife& jackknife, const std::vector<SensorId>& sensors) {
  return jackknife.available ? JackknifeJoint(jackknife, sensors) : AnalyticJoint(graph, solution, sensors);
}

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
  auto of_graph = JointOfGraph(graph, solution, jackknife, sensors);
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
    return RelativeBetween(of_a->second, of_b->second, block(row_a, row_a), block(row_b, row_b), block(row_a, row_b));
  }
  return std::nullopt;
}

PairCovariances CovariancesOfPairs(const std::vector<SensorPair>& pairs, const JointPoses& poses, const Graph& graph,
                                   const GraphSolution& solution, const GraphJackknife& jackknife) {
  constexpr std::size_t kPairsAtOnce = kJointPosesMax / 2;
  PairCovariances covariances;
  JointPoses some = poses;
  for (std::size_t first = 0; first < pairs.size(); first += kPairsAtOnce) {
    const auto part = std::span(pairs).subspan(first, std::min(kPairsAtOnce, pairs.size() - first));
    if (poses.covariances.empty()) some.covariances = JointsOfPairs(part, graph, solution, jackknife);
    for (const SensorPair& pair : part)
      if (const auto relative = RelativeOf(some, pair.a, pair.b)) covariances.emplace(pair, relative->covariance);
  }
  return covariances;
}

}  // namespace rigcal::graph
