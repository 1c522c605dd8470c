#include "tests/bench/rig/joint_session.h"

#include <algorithm>

#include "server/formats/sessions/poses.h"

namespace rigcal {
namespace {

const Target& TargetOfCamera(const SessionHeader& header, const Sensor& camera) {
  const TargetId id = camera.sees.value_or(header.targets.front().id);
  return *std::find_if(header.targets.begin(), header.targets.end(), [&](const Target& t) { return t.id == id; });
}

calib::joint::CameraViews CameraViewsOf(const FeatureSession& session, const Sensor& camera) {
  calib::joint::CameraViews views;
  views.camera = camera;
  views.board = TargetOfCamera(session.header, camera);
  for (const auto& [capture, view] : session.seen.views.at(camera.id)) views.views.emplace_back(capture, view);
  if (auto estimate = calib::EstimateCamera({camera, views.board, views.views})) views.estimate = std::move(*estimate);
  return views;
}

calib::joint::LidarViews LidarViewsOf(const FeatureSession& session, const Sensor& lidar) {
  calib::joint::LidarViews views;
  views.lidar = lidar;
  for (const auto& [capture, clouds] : session.seen.clouds.at(lidar.id))
    for (const auto& [target, cloud] : clouds) views.clouds[capture].push_back(cloud);
  return views;
}

}  // namespace

std::map<SensorId, Se3> NominalPoses(const FeatureSession& session) {
  std::map<SensorId, Se3> poses;
  for (const Sensor& sensor : session.header.sensors)
    poses[sensor.id] = sensor.id == session.header.reference ? Se3{} : sensor.T_ref_nominal.value_or(Se3{});
  return poses;
}

calib::joint::SessionViews ViewsOf(const FeatureSession& session, std::map<SensorId, Se3> T_ref_sensor) {
  calib::joint::SessionViews views;
  views.reference = session.header.reference;
  views.targets = session.header.targets;
  views.boards_stand_still = true;
  views.T_ref_sensor = std::move(T_ref_sensor);
  for (const Sensor& sensor : session.header.sensors) {
    if (sensor.kind == SensorKind::kCamera) views.cameras.push_back(CameraViewsOf(session, sensor));
    if (sensor.kind == SensorKind::kLidar) views.lidars.push_back(LidarViewsOf(session, sensor));
    if (sensor.kind != SensorKind::kTracker) continue;
    const std::string csv = sim::PosesCsv(session.experiment, session.experiment.rig.SensorOf(sensor.id),
                                          session.seen.tracker.at(sensor.id));
    views.trackers.push_back({sensor, formats::ReadPoses(csv, sensor.kind, "poses.csv").value(),
                              formats::ReadTrackerPath(csv, "poses.csv").value()});
  }
  return views;
}

}  // namespace rigcal
