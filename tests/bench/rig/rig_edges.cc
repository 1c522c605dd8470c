#include "tests/bench/rig/rig_edges.h"

#include <algorithm>

#include "client/sim/rig/random.h"
#include "client/sim/views/scan.h"
#include "server/base/process/parallel_for.h"
#include "server/calib/lidar_camera/lidar_camera.h"
#include "server/calib/lidar_lidar/lidar_lidar.h"
#include "server/calib/motion/hand_eye.h"
#include "server/calib/stereo/stereo.h"
#include "server/calib/tracker_lidar/tracker_lidar.h"
#include "server/graph/uncertainty/graph_jackknife.h"

namespace rigcal::sim {
namespace {

const Target& TargetOf(const Experiment& experiment, const Sensor& camera) {
  const TargetId id = camera.sees.value_or(experiment.declared.targets.front().id);
  return *std::find_if(experiment.declared.targets.begin(), experiment.declared.targets.end(),
                       [&](const Target& target) { return target.id == id; });
}

std::optional<Se3> NominalOf(const Experiment& experiment, const Sensor& a, const Sensor& b) {
  const auto nominal = [&](const Sensor& sensor) {
    return sensor.id == experiment.declared.reference ? Se3{} : sensor.T_ref_nominal.value_or(Se3{});
  };
  return nominal(a).Inverse() * nominal(b);
}

Edge StereoEdge(const Experiment& experiment, const Observations& seen, const Sensor& a, const Sensor& b) {
  calib::StereoProblem problem{a, b, TargetOf(experiment, a), {}};
  for (std::size_t k = 0; k < experiment.captures.size(); ++k) {
    calib::StereoCapture capture{experiment.captures[k], {}, {}};
    if (experiment.IsRecorded(a.id, k)) capture.a = seen.views.at(a.id).at(capture.capture);
    if (experiment.IsRecorded(b.id, k)) capture.b = seen.views.at(b.id).at(capture.capture);
    problem.captures.push_back(std::move(capture));
  }
  return calib::EstimateEdge(problem);
}

Edge LidarCameraEdge(const Experiment& experiment, const Observations& seen, const Sensor& a, const Sensor& b) {
  const bool camera_is_a = a.kind == SensorKind::kCamera;
  const Sensor &camera = camera_is_a ? a : b, &lidar = camera_is_a ? b : a;
  calib::LidarCameraProblem problem;
  problem.camera = camera;
  problem.lidar = lidar;
  problem.board = TargetOf(experiment, camera);
  problem.camera_is_a = camera_is_a;
  problem.T_cam_lidar_nominal = NominalOf(experiment, camera, lidar);
  for (std::size_t k = 0; k < experiment.captures.size(); ++k) {
    calib::LidarCameraCapture capture{experiment.captures[k], {}, {}};
    if (experiment.IsRecorded(camera.id, k)) capture.view = seen.views.at(camera.id).at(capture.capture);
    if (experiment.IsRecorded(lidar.id, k))
      capture.cloud = seen.clouds.at(lidar.id).at(capture.capture).at(problem.board.id);
    problem.captures.push_back(std::move(capture));
  }
  return calib::EstimateLidarCameraEdge(problem);
}

std::vector<Eigen::Vector3f> CloudOf(const Experiment& experiment, const Scene& scene, const SensorId& id,
                                     std::size_t k) {
  std::vector<Eigen::Vector3f> points_m;
  const std::vector<ScanPoint> points =
      Scan(scene, experiment.rig.SensorOf(id).lidar, experiment.T_world_sensor(id, k), experiment.beam_bias_m.at(id),
           KeyOf(experiment.options.seed, "scan", id.str(), k));
  for (const ScanPoint& point : points) points_m.push_back(point.p_lidar.cast<float>());
  return points_m;
}

Edge LidarLidarEdge(const Experiment& experiment, const Sensor& a, const Sensor& b) {
  const Scene scene = SceneOf(experiment.rig);
  calib::LidarLidarProblem problem{a, b, NominalOf(experiment, a, b), {}};
  problem.captures.resize(experiment.captures.size());
  ParallelFor(problem.captures.size(), [&](std::size_t k) {
    problem.captures[k].capture = experiment.captures[k];
    if (experiment.IsRecorded(a.id, k)) problem.captures[k].a_m = CloudOf(experiment, scene, a.id, k);
    if (experiment.IsRecorded(b.id, k)) problem.captures[k].b_m = CloudOf(experiment, scene, b.id, k);
  });
  return calib::EstimateLidarLidarEdge(problem);
}

calib::HandEyeSide SideOf(const Experiment& experiment, const Observations& seen, const Sensor& sensor) {
  calib::HandEyeSide side;
  side.sensor = sensor;
  if (sensor.kind != SensorKind::kCamera) {
    for (const TrackerRow& row : seen.tracker.at(sensor.id))
      side.poses.push_back(
          {experiment.captures[row.capture_idx], Stamp{experiment.stamps_ns[row.capture_idx]}, row.T_world_body});
    return side;
  }
  side.board = TargetOf(experiment, sensor);
  for (const auto& [capture, view] : seen.views.at(sensor.id)) side.views.emplace_back(capture, view);
  return side;
}

Edge HandEyeEdge(const Experiment& experiment, const Observations& seen, Method method, const Sensor& a,
                 const Sensor& b) {
  calib::HandEyeProblem problem{method, SideOf(experiment, seen, a), SideOf(experiment, seen, b),
                                NominalOf(experiment, a, b)};
  return calib::EstimateHandEyeEdge(problem);
}

Edge TrackerLidarEdge(const Experiment& experiment, const Observations& seen, const Sensor& a, const Sensor& b) {
  calib::TrackerLidarProblem problem;
  problem.tracker_is_a = a.kind == SensorKind::kTracker;
  problem.tracker = problem.tracker_is_a ? a : b;
  problem.lidar = problem.tracker_is_a ? b : a;
  problem.boards = experiment.declared.targets;
  problem.T_body_lidar_nominal = NominalOf(experiment, problem.tracker, problem.lidar);
  std::map<CaptureId, calib::TrackerLidarCapture> captures;
  for (const TrackerRow& row : seen.tracker.at(problem.tracker.id))
    captures[experiment.captures[row.capture_idx]].T_world_body = row.T_world_body;
  for (const auto& [capture, clouds] : seen.clouds.at(problem.lidar.id))
    for (const auto& [board, cloud] : clouds) captures[capture].clouds.push_back(cloud);
  for (auto& [id, capture] : captures) {
    capture.capture = id;
    problem.captures.push_back(std::move(capture));
  }
  return calib::EstimateTrackerLidarEdge(problem);
}

Edge EdgeOf(const Experiment& experiment, const Observations& seen, const Sensor& a, const Sensor& b) {
  const Method method = MethodFor(experiment.declared, a, b).value();
  if (method == Method::kStereo) return StereoEdge(experiment, seen, a, b);
  if (method == Method::kLidarCamera) return LidarCameraEdge(experiment, seen, a, b);
  if (method == Method::kLidarLidar) return LidarLidarEdge(experiment, a, b);
  if (method == Method::kTrackerLidar) return TrackerLidarEdge(experiment, seen, a, b);
  return HandEyeEdge(experiment, seen, method, a, b);
}

const Sensor& DeclaredOf(const Experiment& experiment, const SensorId& id) {
  return *std::find_if(experiment.declared.sensors.begin(), experiment.declared.sensors.end(),
                       [&](const Sensor& sensor) { return sensor.id == id; });
}

}  // namespace

std::vector<Edge> RigEdges(const Experiment& experiment, const Observations& seen, const RigEdgesOptions& options) {
  std::vector<Edge> edges;
  SessionHeader header = experiment.declared;
  header.skip_pairs = experiment.rig.skip_pairs;
  for (const SensorPair& pair : PairsToCalibrate(header)) {
    const Sensor &a = DeclaredOf(experiment, pair.a), &b = DeclaredOf(experiment, pair.b);
    if (!options.lidar_pairs && a.kind == SensorKind::kLidar && b.kind == SensorKind::kLidar) continue;
    Edge edge = EdgeOf(experiment, seen, a, b);
    edge.robot = experiment.rig.robot;
    edge.session = SessionId(std::string(64, '5'));
    edge.id = EstimatedEdgeId(edge.robot, edge.session, edge.method, edge.frame_a, edge.frame_b);
    edges.push_back(std::move(edge));
  }
  return edges;
}

SolvedRig SolveRig(const Experiment& experiment, const std::vector<Edge>& edges) {
  SolvedRig solved{graph::GraphOf(edges, experiment.declared.reference), {}};
  solved.solution = graph::Solve(solved.graph);
  ApplyJackknifeCovariance(solved.graph, graph::JackknifeGraph(solved.graph, solved.solution, graph::BlocksOf(edges)),
                           solved.solution);
  return solved;
}

Vector6d EdgeError(const Experiment& experiment, const Edge& edge) {
  const Se3 truth = experiment.T_ref_sensor(edge.frame_a).Inverse() * experiment.T_ref_sensor(edge.frame_b);
  return (edge.T_a_b.Inverse() * truth).Log();
}

}  // namespace rigcal::sim
