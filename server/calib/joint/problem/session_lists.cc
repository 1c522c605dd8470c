#include "server/calib/joint/problem/session_lists.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "server/calib/core/capture_blocks.h"
#include "server/calib/joint/problem/board_bend.h"

namespace rigcal::calib::joint {
namespace {

constexpr double kTrackerStart_m = 0.001, kTrackerStart_rad = 0.001;

void AddSensor(const Sensor& sensor, const Se3& T_ref_sensor, SensorNoise noise, SessionStart& start) {
  start.problem.sensors.push_back(sensor.id);
  start.problem.range_bias_sigma_m.push_back(sensor.kind == SensorKind::kLidar ? sensor.range_bias_sigma_m.value_or(0.0)
                                                                               : 0.0);
  start.problem.slant_bias_sigma_m.push_back(0.0);
  start.state.T_ref_sensor.push_back(T_ref_sensor);
  start.state.range_bias_m.push_back(0.0);
  start.state.slant_bias_m.push_back(0.0);
  start.noise.push_back(noise);
}

Lens LensOf(const CameraViews& camera) {
  Lens lens;
  lens.model = camera.camera.camera_model;
  for (const auto& [capture, view] : camera.views)
    lens.picture = {std::max(lens.picture.width_px, view.image_width_px),
                    std::max(lens.picture.height_px, view.image_height_px)};
  if (!camera.camera.intrinsics) {
    lens.refined.resize(static_cast<std::size_t>(IntrinsicsCount(lens.model)));
    std::iota(lens.refined.begin(), lens.refined.end(), 0);
  } else if (!HoldsIntrinsics(camera.camera)) {
    lens.refined = RefinedOf(camera.camera);
    lens.given = camera.estimate.pull.given;
    if (camera.estimate.pull.Pulls()) lens.sigma = camera.estimate.pull.sigma;
  } else {
    lens.given = VectorOf(*camera.camera.intrinsics);
    lens.is_exact = true;
  }
  lens.is_given = camera.camera.intrinsics.has_value();
  return lens;
}

void ListSensors(const SessionViews& views, const std::set<SensorId>& left_out, SessionLists& lists) {
  SessionStart& start = lists.start;
  start.problem.reference = kNone;
  const auto add = [&](const Sensor& sensor, SensorNoise noise) {
    const auto pose = views.T_ref_sensor.find(sensor.id);
    if (pose == views.T_ref_sensor.end() || left_out.contains(sensor.id)) return false;
    if (sensor.id == views.reference) start.problem.reference = static_cast<int>(start.problem.sensors.size());
    AddSensor(sensor, pose->second, noise, start);
    return true;
  };
  for (const CameraViews& camera : views.cameras) {
    if (IndexOf(start.problem, camera.camera.id) != kNone) continue;  // of another board: one sensor, one lens
    if (!add(camera.camera, {std::sqrt(std::max(1e-4, camera.estimate.variance_px2)), 0.0})) continue;
    lists.lens_of_camera[camera.camera.id] = static_cast<int>(start.problem.cameras.size());
    start.problem.cameras.push_back(LensOf(camera));
    start.state.intrinsics.push_back(VectorOf(camera.estimate.intrinsics));
    start.state.pupil_shift_m.push_back(0.0);
  }
  for (const LidarViews& lidar : views.lidars) add(lidar.lidar, {1.0, 0.0});
  for (const TrackerPoses& tracker : views.trackers) add(tracker.tracker, {kTrackerStart_m, kTrackerStart_rad});
}

void ListTargets(const std::vector<Target>& targets, SessionStart& start) {
  start.problem.targets = targets;
  for (const Target& target : targets) {
    start.problem.target_points.push_back(TargetPoints(target));
    start.problem.target_bend_shapes.push_back(BendShapes(target));
    start.problem.bend_sigma_m.push_back(0.0);
    start.problem.strain_sigma_ratio.push_back(0.0);
    start.state.board_scale_ratio.push_back(0.0);
    start.state.board_bend_m.emplace_back(Eigen::Vector3d::Zero());
    start.state.print_strain_ratio.emplace_back(Eigen::Vector3d::Zero());
  }
}

std::vector<CaptureId> CapturesOf(const SessionViews& views) {
  std::set<CaptureId, TakenBefore> captures;
  for (const CameraViews& camera : views.cameras)
    for (const auto& [capture, pose] : camera.estimate.T_cam_board) captures.insert(capture);
  for (const TrackerPoses& tracker : views.trackers)
    for (const TimedPose& row : tracker.poses) captures.insert(row.capture);
  return {captures.begin(), captures.end()};
}

}  // namespace

SessionLists ListsOf(const SessionViews& views, const std::set<SensorId>& left_out) {
  SessionLists lists;
  ListSensors(views, left_out, lists);
  ListTargets(views.targets, lists.start);
  lists.start.problem.captures = CapturesOf(views);
  return lists;
}

int IndexOf(const SessionProblem& problem, const SensorId& sensor) {
  const auto at = std::find(problem.sensors.begin(), problem.sensors.end(), sensor);
  return at == problem.sensors.end() ? kNone : static_cast<int>(at - problem.sensors.begin());
}

}  // namespace rigcal::calib::joint
