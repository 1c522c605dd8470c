#include "server/pipeline/reports/cloud_choice.h"

#include <algorithm>
#include <map>
#include <set>
#include <tuple>

#include "server/base/limits.h"
#include "server/pipeline/sessions/current_edges.h"
#include "server/pipeline/sessions/refined_lenses.h"
#include "storage/sessions/sessions.h"

namespace rigcal::pipeline {
namespace {

using Poses = std::map<SensorId, Se3>;  // T_ref_sensor, known ones

Poses KnownPoses(const formats::RevisionInput& revision) {
  Poses poses;
  for (const SensorPose& pose : revision.solution.poses)
    if (pose.known) poses[pose.sensor] = pose.T_ref_sensor;
  return poses;
}

// Behind the edges, newest first.
Result<std::vector<SessionId>> SessionsOf(storage::Store& store, const formats::RevisionInput& revision) {
  std::set<SessionId> ids;
  for (const Edge& edge : revision.edges)
    if (!edge.session.empty()) ids.insert(edge.session);
  std::vector<std::pair<Stamp, SessionId>> dated;
  for (const SessionId& id : ids) {
    RIGCAL_ASSIGN(const auto row, storage::LoadSession(store, id));
    if (row) dated.emplace_back(row->captured_at, id);
  }
  std::sort(dated.begin(), dated.end(),
            [](const auto& x, const auto& y) { return x.first != y.first ? y.first < x.first : x.second < y.second; });
  std::vector<SessionId> sorted;
  for (const auto& [stamp, id] : dated) sorted.push_back(id);
  return sorted;
}

std::optional<double> Figure(const Edge& edge, const std::string& name) {
  const auto it = edge.figures.find(name);
  return it == edge.figures.end() ? std::nullopt : std::optional(it->second);
}

// One session, as the revision has it, with the lenses that it was refined with.
struct SessionInRevision {
  const Manifest& manifest;
  const SessionId& session;
  const formats::RevisionInput& revision;
  const std::vector<RefinedLens>& lenses;
};

std::optional<CameraIntrinsics> IntrinsicsOf(const Sensor& camera, const SessionInRevision& of) {
  if (camera.intrinsics && !camera.intrinsics_sigma) return camera.intrinsics;
  for (const RefinedLens& lens : of.lenses)
    if (lens.camera == camera.id && lens.intrinsics.model == camera.camera_model) return lens.intrinsics;
  for (const Edge& edge : of.revision.edges)
    if (edge.session == of.session && edge.state == EdgeState::kGood)
      if (auto found = EstimatedIntrinsics(edge, camera.id, camera.camera_model)) return found;
  return camera.intrinsics;
}

struct ReadyCamera {
  SensorId id;
  CameraIntrinsics intrinsics;
  Se3 T_ref_camera;
};

std::vector<ReadyCamera> ReadyCameras(const SessionInRevision& of, const Poses& poses) {
  std::vector<ReadyCamera> cameras;
  for (const Sensor& sensor : of.manifest.header.sensors) {
    const auto pose = poses.find(sensor.id);
    if (sensor.kind != SensorKind::kCamera || pose == poses.end()) continue;
    if (const auto intrinsics = IntrinsicsOf(sensor, of)) cameras.push_back({sensor.id, *intrinsics, pose->second});
  }
  return cameras;
}

// Without those that the session does not pair with the lidar, as the paper colours each lidar from its own cameras;
// all where it pairs none.
std::vector<ReadyCamera> PairedWith(const SensorId& lidar, const std::vector<ReadyCamera>& cameras,
                                    const SessionHeader& header) {
  std::vector<ReadyCamera> paired = cameras;
  std::erase_if(paired, [&](const ReadyCamera& camera) { return IsSkipped(header, lidar, camera.id); });
  return paired.empty() ? cameras : paired;
}

using PayloadsOf = std::map<SensorId, std::map<CaptureId, const Payload*>>;

PayloadsOf BySensor(const Manifest& manifest) {
  PayloadsOf payloads;
  for (const Payload& payload : manifest.payloads) payloads[payload.sensor][payload.capture] = &payload;
  return payloads;
}

// The cameras with a picture of the capture.
std::vector<PlacedCamera> PlacedAt(const CaptureId& capture, const Se3& T_ref_lidar, const PayloadsOf& payloads,
                                   const std::vector<ReadyCamera>& cameras) {
  std::vector<PlacedCamera> placed;
  for (const ReadyCamera& camera : cameras) {
    const auto own = payloads.find(camera.id);
    if (own == payloads.end() || !own->second.contains(capture)) continue;
    placed.push_back(
        {camera.id, {camera.intrinsics, camera.T_ref_camera.Inverse() * T_ref_lidar}, own->second.at(capture)});
  }
  return placed;
}

CloudChoice ChoiceOf(const SensorId& lidar, const Se3& T_ref_lidar, const PayloadsOf& payloads,
                     const std::vector<ReadyCamera>& cameras) {
  CloudChoice choice;
  choice.lidar = lidar, choice.T_ref_lidar = T_ref_lidar;
  const auto clouds = payloads.find(lidar);
  if (clouds == payloads.end()) return choice;
  for (const auto& [capture, payload] : clouds->second) {
    std::vector<PlacedCamera> placed = PlacedAt(capture, T_ref_lidar, payloads, cameras);
    if (placed.size() <= choice.cameras.size()) continue;
    choice.cloud = payload, choice.cameras = std::move(placed);
  }
  if (choice.cameras.size() > limits::kCloudCamerasMax) {
    choice.cameras_left_out = choice.cameras.size() - limits::kCloudCamerasMax;
    choice.cameras.resize(limits::kCloudCamerasMax);
  }
  return choice;
}

// Those that are still where they were at the session.
Poses StillThere(const Poses& poses, const SessionId& session, const Epochs& epochs) {
  Poses still = poses;
  std::erase_if(still, [&](const auto& pose) { return epochs.After(session, pose.first) != nullptr; });
  return still;
}

std::vector<CloudChoice> ChoicesIn(const SessionInRevision& of, const Poses& poses) {
  const Manifest& manifest = of.manifest;
  const std::vector<ReadyCamera> all = ReadyCameras(of, poses);
  const PayloadsOf payloads = BySensor(manifest);
  std::vector<CloudChoice> choices;
  for (const Sensor& sensor : manifest.header.sensors) {
    const auto pose = poses.find(sensor.id);
    if (sensor.kind != SensorKind::kLidar || pose == poses.end()) continue;
    const std::vector<ReadyCamera> cameras = PairedWith(sensor.id, all, manifest.header);
    CloudChoice choice = ChoiceOf(sensor.id, pose->second, payloads, cameras);
    choice.layout = sensor.layout;
    if (!choice.cameras.empty()) choices.push_back(std::move(choice));
  }
  return choices;
}

}  // namespace

std::optional<CameraIntrinsics> EstimatedIntrinsics(const Edge& edge, const SensorId& sensor, CameraModel model) {
  if (edge.frame_a != sensor && edge.frame_b != sensor) return std::nullopt;
  // An edge of two cameras says whose they are; one of a lidar and a camera has only one to speak of.
  const std::string whose = edge.figures.contains("fx_px") ? "" : edge.frame_a == sensor ? "a_" : "b_";
  CameraIntrinsics intrinsics;
  intrinsics.model = model, intrinsics.distortion.clear();
  for (const auto& [name, value] : {std::pair("fx_", &intrinsics.fx_px), std::pair("fy_", &intrinsics.fy_px),
                                    std::pair("cx_", &intrinsics.cx_px), std::pair("cy_", &intrinsics.cy_px)}) {
    const auto found = Figure(edge, name + whose + "px");
    if (!found) return std::nullopt;
    *value = *found;
  }
  for (const std::string& name : DistortionNames(model)) {
    const auto found = Figure(edge, name + "_" + whose + "ratio");
    if (!found) return std::nullopt;
    intrinsics.distortion.push_back(*found);
  }
  return intrinsics;
}

Result<CloudChoices> ChooseClouds(storage::Store& store, const formats::RevisionInput& revision) {
  const Poses poses = KnownPoses(revision);
  RIGCAL_ASSIGN(const std::vector<SessionId> sessions, SessionsOf(store, revision));
  RIGCAL_ASSIGN(const Epochs epochs, Epochs::Load(store, revision.robot));
  RIGCAL_ASSIGN(auto lenses, LoadRefinedLenses(store, revision));
  for (const SessionId& session : sessions) {
    RIGCAL_ASSIGN(auto manifest, storage::LoadManifest(store, session));
    if (!manifest) continue;
    CloudChoices choices{std::make_shared<const Manifest>(std::move(*manifest)), {}};
    choices.lidars =
        ChoicesIn({*choices.manifest, session, revision, lenses[session]}, StillThere(poses, session, epochs));
    if (!choices.lidars.empty()) return choices;
  }
  return CloudChoices{};
}

}  // namespace rigcal::pipeline
