#include <algorithm>

#include "server/graph/observability.h"
#include "server/graph/solve.h"
#include "server/graph/start_poses.h"
#include "server/math/covariance.h"

namespace rigcal::graph {
namespace {

Result<std::size_t> FindSensor(const Graph& graph, const SensorId& sensor) {
  const auto found = std::find(graph.sensors.begin(), graph.sensors.end(), sensor);
  if (found == graph.sensors.end())
    return Fail(ErrorCode::kNotFound, "sensor " + sensor.str() + " is not in the graph",
                "Check the name; the robot's report lists its sensors.");
  return static_cast<std::size_t>(found - graph.sensors.begin());
}

Result<const SensorPose*> FindKnown(const Graph& graph, const GraphSolution& solution, std::size_t sensor) {
  const SensorId& id = graph.sensors[sensor];
  const auto pose = std::find_if(solution.poses.begin(), solution.poses.end(),
                                 [&id](const SensorPose& candidate) { return candidate.sensor == id; });
  if (pose != solution.poses.end() && pose->known) return &*pose;
  const std::string prefix = "sensor " + id.str() + " ";
  const auto why = std::find_if(solution.diagnoses.begin(), solution.diagnoses.end(),
                                [&prefix](const Diagnosis& d) { return d.what.find(prefix) != std::string::npos; });
  if (why != solution.diagnoses.end()) return Fail(ErrorCode::kInvalidInput, why->what, why->cure);
  return Fail(ErrorCode::kInvalidInput, "the pose of sensor " + id.str() + " is not known in this solution",
              "Add an edge that connects it with " + graph.reference.str() + ".");
}

// Covariance blocks of the columns of two vertices; the reference's are zero.
struct JointCovariance {
  Matrix6d C_AA = Matrix6d::Zero(), C_BB = Matrix6d::Zero(), C_AB = Matrix6d::Zero();
};

Result<JointCovariance> SolveColumns(const Problem& problem, const Poses& T_ref, int a, int b) {
  const auto cholesky = FactorAt(problem, T_ref);
  if (cholesky == nullptr)
    return Fail(
        ErrorCode::kInvalidInput,
        "the uncertainty between these sensors cannot be computed: the graph is too large, or the information of "
        "its edges spans too many orders of magnitude",
        "Check the information matrices of the edges for wrong units (metres and radians).");
  Eigen::MatrixXd columns = Eigen::MatrixXd::Zero(6 * problem.free_count(), 12);
  if (a > 0) columns.block<6, 6>(6 * (a - 1), 0).setIdentity();
  if (b > 0) columns.block<6, 6>(6 * (b - 1), 6).setIdentity();
  cholesky->SolveInPlace(columns);
  JointCovariance joint;
  if (a > 0) joint.C_AA = columns.block<6, 6>(6 * (a - 1), 0);
  if (b > 0) joint.C_BB = columns.block<6, 6>(6 * (b - 1), 6);
  if (a > 0 && b > 0) joint.C_AB = columns.block<6, 6>(6 * (a - 1), 6);
  return joint;
}

}  // namespace

Result<RelativePose> Relative(const Graph& graph, const GraphSolution& solution, const SensorId& a, const SensorId& b) {
  RIGCAL_ASSIGN(const std::size_t sensor_a, FindSensor(graph, a));
  RIGCAL_ASSIGN(const std::size_t sensor_b, FindSensor(graph, b));
  RIGCAL_ASSIGN(const SensorPose* pose_a, FindKnown(graph, solution, sensor_a));
  RIGCAL_ASSIGN(const SensorPose* pose_b, FindKnown(graph, solution, sensor_b));
  RelativePose relative;
  if (a == b) return relative;
  relative.T_A_B = (pose_a->T_ref_sensor.Inverse() * pose_b->T_ref_sensor).Normalized();
  const Problem problem = MakeProblem(graph);
  const int vertex_a = problem.vertex_of_sensor[sensor_a], vertex_b = problem.vertex_of_sensor[sensor_b];
  if (vertex_a < 0 || vertex_b < 0)
    return Fail(ErrorCode::kInvalidInput, "sensors " + a.str() + " and " + b.str() + " are not connected in this graph",
                "Solve the graph again with the edges that it has now.");
  RIGCAL_ASSIGN(const JointCovariance joint,
                SolveColumns(problem, SolvedPoses(graph, problem, solution), vertex_a, vertex_b));
  relative.covariance = RelativeCovariance(relative.T_A_B, joint.C_AA, joint.C_BB, joint.C_AB);
  return relative;
}

}  // namespace rigcal::graph
