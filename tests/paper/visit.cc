#include "tests/paper/visit.h"

#include <algorithm>

#include "client/sim/rig/random.h"
#include "client/sim/rig/scene.h"
#include "client/sim/views/scan.h"
#include "server/base/digests/sha256.h"
#include "server/base/process/parallel_for.h"
#include "server/calib/lidar_camera/lidar_camera.h"
#include "server/calib/lidar_lidar/lidar_lidar.h"
#include "server/calib/motion/hand_eye.h"
#include "server/calib/stereo/stereo.h"

namespace rigcal::paper {
namespace {

using sim::Experiment;
using sim::Observations;

const Sensor& DeclaredOf(const SessionHeader& header, const SensorId& id) {
  return *std::find_if(header.sensors.begin(), header.sensors.end(), [&](const Sensor& s) { return s.id == id; });
}

const Target& TargetOf(const SessionHeader& header, const TargetId& id) {
  return *std::find_if(header.targets.begin(), header.targets.end(), [&](const Target& t) { return t.id == id; });
}

std::optional<Se3> NominalOf(const SessionHeader& header, const Sensor& a, const Sensor& b) {
  const auto pose = [&](const Sensor& sensor) { return sensor.id == header.reference ? Se3{} : *sensor.T_ref_nominal; };
  return pose(a).Inverse() * pose(b);
}

Edge StereoEdge(const Experiment& experiment, const Observations& seen, const Sensor& a, const Sensor& b) {
  calib::StereoProblem problem{a, b, TargetOf(experiment.declared, *a.sees), {}};
  for (const CaptureId& capture : experiment.captures)
    problem.captures.push_back({capture, seen.views.at(a.id).at(capture), seen.views.at(b.id).at(capture)});
  return calib::EstimateEdge(problem);
}

Edge LidarCameraEdge(const Experiment& experiment, const Observations& seen, const Sensor& a, const Sensor& b) {
  calib::LidarCameraProblem problem;
  problem.camera_is_a = a.kind == SensorKind::kCamera;
  problem.camera = problem.camera_is_a ? a : b;
  problem.lidar = problem.camera_is_a ? b : a;
  problem.board = TargetOf(experiment.declared, *problem.camera.sees);
  problem.T_cam_lidar_nominal = NominalOf(experiment.declared, problem.camera, problem.lidar);
  for (const CaptureId& capture : experiment.captures)
    problem.captures.push_back({capture, seen.views.at(problem.camera.id).at(capture),
                                seen.clouds.at(problem.lidar.id).at(capture).at(problem.board.id)});
  return calib::EstimateLidarCameraEdge(problem);
}

calib::HandEyeSide SideOf(const Experiment& experiment, const Observations& seen, const Sensor& sensor) {
  calib::HandEyeSide side{sensor, {}, {}, {}};
  if (sensor.kind == SensorKind::kCamera) {
    side.board = TargetOf(experiment.declared, *sensor.sees);
    for (const CaptureId& capture : experiment.captures)
      side.views.emplace_back(capture, seen.views.at(sensor.id).at(capture));
  } else {
    for (const sim::TrackerRow& row : seen.tracker.at(sensor.id))
      side.poses.push_back(
          {experiment.captures[row.capture_idx], Stamp{experiment.stamps_ns[row.capture_idx]}, row.T_world_body});
  }
  return side;
}

Edge HandEyeEdge(const Experiment& experiment, const Observations& seen, const Sensor& a, const Sensor& b,
                 Method method) {
  return calib::EstimateHandEyeEdge(
      {method, SideOf(experiment, seen, a), SideOf(experiment, seen, b), NominalOf(experiment.declared, a, b)});
}

std::vector<Eigen::Vector3f> CloudOf(const Experiment& experiment, const sim::Scene& scene, const SensorId& lidar,
                                     std::size_t capture_idx) {
  std::vector<Eigen::Vector3f> points_m;
  for (const sim::ScanPoint& point : sim::Scan(
           scene, experiment.rig.SensorOf(lidar).lidar, experiment.T_world_sensor(lidar, capture_idx),
           experiment.beam_bias_m.at(lidar), sim::KeyOf(experiment.options.seed, "scan", lidar.str(), capture_idx)))
    points_m.push_back(point.p_lidar.cast<float>());
  return points_m;
}

Edge LidarLidarEdge(const Experiment& experiment, const Sensor& a, const Sensor& b, std::size_t captures_max) {
  const sim::Scene scene = sim::SceneOf(experiment.rig);
  const std::size_t total = experiment.captures.size(), count = std::min(captures_max, total);
  calib::LidarLidarProblem problem;
  problem.lidar_a = a;
  problem.lidar_b = b;
  problem.T_a_b_nominal = NominalOf(experiment.declared, a, b);
  for (std::size_t i = 0; i < count; ++i) {
    const std::size_t k = i * total / count;
    problem.captures.push_back(
        {experiment.captures[k], CloudOf(experiment, scene, a.id, k), CloudOf(experiment, scene, b.id, k), {}});
  }
  return calib::EstimateLidarLidarEdge(problem);
}

struct Job {
  const Sensor *a, *b;
  Method method;
  bool other_method = false;
};

std::vector<Job> JobsOf(const Experiment& experiment, const std::vector<SensorPair>& only) {
  SessionHeader pairs_of = experiment.declared;
  pairs_of.skip_pairs = experiment.rig.skip_pairs;
  std::vector<Job> jobs;
  for (const SensorPair& pair : only.empty() ? PairsToCalibrate(pairs_of) : only) {
    const Sensor &a = DeclaredOf(experiment.declared, pair.a), &b = DeclaredOf(experiment.declared, pair.b);
    jobs.push_back({&a, &b, MethodFor(experiment.declared, a, b).value(), false});
    if (jobs.back().method == Method::kStereo) jobs.push_back({&a, &b, Method::kNonOverlapping, true});
  }
  return jobs;
}

Edge Estimated(const Experiment& experiment, const Observations& seen, const Job& job, const VisitOptions& how) {
  if (job.method == Method::kStereo) return StereoEdge(experiment, seen, *job.a, *job.b);
  if (job.method == Method::kLidarCamera) return LidarCameraEdge(experiment, seen, *job.a, *job.b);
  if (job.method == Method::kLidarLidar) return LidarLidarEdge(experiment, *job.a, *job.b, how.lidar_pair_captures);
  return HandEyeEdge(experiment, seen, *job.a, *job.b, job.method);
}

Edge EdgeOf(const Experiment& experiment, const Observations& seen, const Job& job, const VisitOptions& how) {
  Edge edge = Estimated(experiment, seen, job, how);
  edge.robot = experiment.declared.robot;
  edge.session = SessionId(Sha256Of("visit " + std::to_string(experiment.options.seed)).str());
  edge.id = EstimatedEdgeId(edge.robot, edge.session, edge.method, edge.frame_a, edge.frame_b);
  return edge;
}

}  // namespace

Result<Visit> MakeVisit(const sim::Rig& rig, const sim::Options& options, const VisitOptions& how) {
  RIGCAL_ASSIGN(sim::Experiment prepared, sim::Prepare(rig, options));
  Visit visit{std::move(prepared), {}, {}};
  const Experiment& experiment = visit.experiment;
  const Observations seen = sim::Observe(experiment);
  const std::vector<Job> jobs = JobsOf(experiment, how.only);
  std::vector<Edge> edges(jobs.size());
  ParallelFor(
      jobs.size(), [&](std::size_t i) { edges[i] = EdgeOf(experiment, seen, jobs[i], how); }, how.threads);
  for (std::size_t i = 0; i < jobs.size(); ++i)
    (jobs[i].other_method ? visit.other_method : visit.edges).push_back(std::move(edges[i]));
  return visit;
}

std::vector<Edge> GoodEdges(const Visit& visit) {
  std::vector<Edge> good;
  std::copy_if(visit.edges.begin(), visit.edges.end(), std::back_inserter(good),
               [](const Edge& edge) { return edge.state == EdgeState::kGood; });
  return good;
}

Se3 TruthOf(const sim::Experiment& experiment, const SensorId& a, const SensorId& b) {
  return experiment.T_ref_sensor(a).Inverse() * experiment.T_ref_sensor(b);
}

}  // namespace rigcal::paper
