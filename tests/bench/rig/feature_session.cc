#include "tests/bench/rig/feature_session.h"

#include <algorithm>
#include <cstdio>
#include <cstdlib>

#include "client/sim/rig/random.h"
#include "server/base/digests/sha256.h"
#include "server/base/process/parallel_for.h"
#include "server/formats/sessions/poses.h"
#include "server/graph/uncertainty/graph_jackknife.h"

namespace rigcal {
namespace {

const Sensor& SensorNamed(const FeatureSession& session, const SensorId& id) {
  for (const Sensor& sensor : session.header.sensors)
    if (sensor.id == id) return sensor;
  std::fprintf(stderr, "no sensor %s\n", id.str().c_str());
  std::exit(2);
}

const Target& TargetOf(const FeatureSession& session, const Sensor& camera) {
  for (const Target& target : session.header.targets)
    if (!camera.sees || target.id == *camera.sees) return target;
  std::fprintf(stderr, "no target of %s\n", camera.id.str().c_str());
  std::exit(2);
}

Method MethodOf(const FeatureSession& session, const SensorPair& pair) {
  return MethodFor(session.header, SensorNamed(session, pair.a), SensorNamed(session, pair.b)).value();
}

std::vector<Eigen::Vector3f> WholeCloud(const sim::Experiment& experiment, const sim::RigSensor& lidar,
                                        std::size_t capture_idx, int of_firings) {
  sim::LidarTruth sparse = lidar.lidar;
  sparse.firings_per_turn /= of_firings;
  std::vector<Eigen::Vector3f> points_m;
  for (const sim::ScanPoint& point :
       sim::Scan(sim::SceneAt(experiment, capture_idx), sparse, experiment.T_world_sensor(lidar.id, capture_idx),
                 experiment.beam_bias_m.at(lidar.id),
                 sim::KeyOf(experiment.options.seed, "whole scan", lidar.id.str(), capture_idx)))
    points_m.push_back(point.p_lidar.cast<float>());
  return points_m;
}

void DrawClouds(std::size_t lidar_captures, int of_firings, FeatureSession& session) {
  const sim::Experiment& experiment = session.experiment;
  struct Slot {
    const sim::RigSensor* lidar;
    std::size_t capture_idx;
    std::vector<Eigen::Vector3f> points_m;
  };
  std::vector<Slot> slots;
  const std::size_t count = std::min(lidar_captures, experiment.captures.size());
  for (const sim::RigSensor& sensor : experiment.rig.sensors)
    for (std::size_t i = 0; sensor.kind == SensorKind::kLidar && i < count; ++i)
      slots.push_back({&sensor, i * experiment.captures.size() / count, {}});
  ParallelFor(slots.size(), [&](std::size_t i) {
    slots[i].points_m = WholeCloud(experiment, *slots[i].lidar, slots[i].capture_idx, of_firings);
  });
  for (Slot& slot : slots)
    session.clouds[slot.lidar->id][experiment.captures[slot.capture_idx]] = std::move(slot.points_m);
}

calib::HandEyeSide SideOf(const FeatureSession& session, const Sensor& sensor) {
  calib::HandEyeSide side;
  side.sensor = sensor;
  if (sensor.kind == SensorKind::kCamera) {
    side.board = TargetOf(session, sensor);
    for (const auto& [capture, view] : session.seen.views.at(sensor.id)) side.views.emplace_back(capture, view);
    return side;
  }
  const std::string csv =
      sim::PosesCsv(session.experiment, session.experiment.rig.SensorOf(sensor.id), session.seen.tracker.at(sensor.id));
  side.poses = formats::ReadPoses(csv, sensor.kind, "poses.csv").value();
  return side;
}

}  // namespace

FeatureSession RecordFeatures(const sim::Experiment& experiment, std::size_t lidar_captures, int of_firings) {
  FeatureSession session{experiment, experiment.declared, sim::Observe(experiment), {}};
  session.header.skip_pairs = experiment.rig.skip_pairs;
  DrawClouds(lidar_captures, of_firings, session);
  return session;
}

calib::StereoProblem StereoOf(const FeatureSession& session, const SensorPair& pair) {
  const Sensor &a = SensorNamed(session, pair.a), &b = SensorNamed(session, pair.b);
  calib::StereoProblem problem{a, b, TargetOf(session, a), {}};
  problem.session_captures = session.experiment.captures;
  std::map<CaptureId, calib::StereoCapture> captures;
  for (const auto& [id, view] : session.seen.views.at(a.id)) captures[id].a = view;
  for (const auto& [id, view] : session.seen.views.at(b.id)) captures[id].b = view;
  for (auto& [id, capture] : captures) {
    capture.capture = id;
    problem.captures.push_back(std::move(capture));
  }
  return problem;
}

calib::LidarCameraProblem LidarCameraOf(const FeatureSession& session, const SensorPair& pair) {
  const Sensor &a = SensorNamed(session, pair.a), &b = SensorNamed(session, pair.b);
  const bool camera_is_a = a.kind == SensorKind::kCamera;
  const Sensor &camera = camera_is_a ? a : b, &lidar = camera_is_a ? b : a;
  calib::LidarCameraProblem problem{camera, lidar, TargetOf(session, camera), {}, camera_is_a, 0.0, {}};
  problem.T_cam_lidar_nominal = NominalPose(session.header, camera, lidar);
  problem.session_captures = session.experiment.captures;
  std::map<CaptureId, calib::LidarCameraCapture> captures;
  for (const auto& [id, view] : session.seen.views.at(camera.id)) captures[id].view = view;
  for (const auto& [id, boards] : session.seen.clouds.at(lidar.id))
    if (const auto cloud = boards.find(problem.board.id); cloud != boards.end()) captures[id].cloud = cloud->second;
  for (auto& [id, capture] : captures) {
    capture.capture = id;
    problem.captures.push_back(std::move(capture));
  }
  return problem;
}

calib::LidarLidarProblem LidarLidarOf(const FeatureSession& session, const SensorPair& pair) {
  calib::LidarLidarProblem problem;
  problem.lidar_a = SensorNamed(session, pair.a);
  problem.lidar_b = SensorNamed(session, pair.b);
  problem.T_a_b_nominal = NominalPose(session.header, SensorNamed(session, pair.a), SensorNamed(session, pair.b));
  problem.session_captures = session.experiment.captures;
  for (const auto& [id, points_m] : session.clouds.at(pair.a))
    problem.captures.push_back({id, points_m, session.clouds.at(pair.b).at(id), {}});
  return problem;
}

calib::HandEyeProblem HandEyeOf(const FeatureSession& session, const SensorPair& pair) {
  calib::HandEyeProblem problem;
  problem.method = MethodOf(session, pair);
  problem.a = SideOf(session, SensorNamed(session, pair.a));
  problem.b = SideOf(session, SensorNamed(session, pair.b));
  problem.T_a_b_nominal = NominalPose(session.header, SensorNamed(session, pair.a), SensorNamed(session, pair.b));
  problem.session_captures = session.experiment.captures;
  return problem;
}

std::vector<SensorPair> PairsOf(const FeatureSession& session) {
  std::vector<SensorPair> pairs = PairsToCalibrate(session.header);
  if (session.clouds.empty())
    std::erase_if(pairs, [&](const SensorPair& pair) { return MethodOf(session, pair) == Method::kLidarLidar; });
  return pairs;
}

Edge EdgeOf(const FeatureSession& session, const SensorPair& pair, calib::CameraMemory* cameras) {
  const Method method = MethodOf(session, pair);
  const auto remembering = [cameras](auto problem) {
    if (cameras != nullptr)
      problem.solve_camera = [cameras](const calib::CameraProblem& camera) { return cameras->Estimate(camera); };
    return problem;
  };
  Edge edge = method == Method::kStereo ? calib::EstimateEdge(StereoOf(session, pair))
              : method == Method::kLidarCamera
                  ? calib::EstimateLidarCameraEdge(remembering(LidarCameraOf(session, pair)))
              : method == Method::kLidarLidar ? calib::EstimateLidarLidarEdge(LidarLidarOf(session, pair))
                                              : calib::EstimateHandEyeEdge(remembering(HandEyeOf(session, pair)));
  edge.robot = session.header.robot;
  edge.session = SessionId(Sha256Of("seed " + std::to_string(session.experiment.options.seed)).str());
  edge.id = EstimatedEdgeId(edge.robot, edge.session, edge.method, edge.frame_a, edge.frame_b);
  return edge;
}

std::vector<Edge> EdgesOf(const FeatureSession& session) {
  const std::vector<SensorPair> pairs = PairsOf(session);
  std::vector<Edge> edges(pairs.size());
  calib::CameraMemory cameras;  // as the service has it
  ParallelFor(pairs.size(), [&](std::size_t i) { edges[i] = EdgeOf(session, pairs[i], &cameras); });
  return edges;
}

GraphSolution SolveRig(const std::vector<Edge>& edges, const SensorId& reference) {
  const Graph graph = graph::GraphOf(edges, reference);
  GraphSolution solution = graph::Solve(graph);
  graph::ApplyJackknifeCovariance(graph, graph::JackknifeGraph(graph, solution, graph::BlocksOf(edges)), solution);
  return solution;
}

}  // namespace rigcal
