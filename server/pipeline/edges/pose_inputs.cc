#include "server/pipeline/edges/pose_inputs.h"

#include <algorithm>
#include <map>
#include <set>

#include "server/base/limits.h"
#include "server/detect/clouds/cloud_board.h"
#include "server/formats/sessions/poses.h"
#include "server/pipeline/edges/lost_payloads.h"
#include "server/pipeline/edges/pair_inputs.h"
#include "server/pipeline/edges/sightings.h"

namespace rigcal::pipeline {
namespace {

std::set<CaptureId> OtherCaptures(const Manifest& manifest, const SensorId& tracker) {
  std::set<CaptureId> captures;
  for (const Payload& payload : manifest.payloads)
    if (payload.sensor != tracker) captures.insert(payload.capture);
  return captures;
}

struct PoseFile {
  std::string text, path;
};

Result<PoseFile> LoadPoseFile(storage::Store& store, const Manifest& manifest, const Sensor& sensor) {
  const auto payload = std::find_if(manifest.payloads.begin(), manifest.payloads.end(),
                                    [&](const Payload& p) { return p.sensor == sensor.id; });
  if (payload == manifest.payloads.end())
    return Fail(ErrorCode::kNotFound, "sensor " + sensor.id.str() + " has no poses.csv",
                "Put its poses into " + sensor.id.str() + "/poses.csv and push the session again.");
  RIGCAL_ASSIGN(std::string text, LoadPayload(store.blobs(), *payload, limits::kPoseTableBytesMax));
  return PoseFile{std::move(text), payload->path};
}

struct SideInputs {
  calib::HandEyeSide side;
  std::vector<Evidence> evidence;  // in capture order
};

void AddEvidence(const SensorId& camera, const CaptureId& capture, const storage::StoredView& seen,
                 std::vector<Evidence>& evidence) {
  if (seen.picture.empty()) return;
  const std::string found =
      seen.view.found ? std::to_string(seen.view.corners_px.size()) + " corners" : seen.view.why_not;
  evidence.push_back({EvidenceTitle(camera, capture, found), camera, capture, seen.picture, "jpg"});
}

Result<SideInputs> LoadCamera(storage::Store& store, const Manifest& manifest, const Sensor& camera) {
  SideInputs inputs;
  Sightings<storage::StoredView> best;
  for (const Target* target : CommonTargets(manifest.header, camera, camera)) {
    RIGCAL_ASSIGN(Sightings<storage::StoredView> views, DetectInImages(store, manifest, camera.id, *target));
    if (inputs.side.board && CountFound(views) <= CountFound(best)) continue;
    inputs.side.board = *target;
    best = std::move(views);
  }
  for (auto& [capture, seen] : best) {
    AddEvidence(camera.id, capture, seen, inputs.evidence);
    inputs.side.views.emplace_back(capture, std::move(seen.view));
  }
  return inputs;
}

Result<SideInputs> LoadTable(storage::Store& store, const Manifest& manifest, const Sensor& sensor) {
  SideInputs inputs;
  RIGCAL_ASSIGN(inputs.side.poses, LoadPoses(store, manifest, sensor));
  return inputs;
}

Result<SideInputs> LoadSide(storage::Store& store, const Manifest& manifest, const Sensor& sensor) {
  RIGCAL_ASSIGN(SideInputs inputs, sensor.kind == SensorKind::kCamera ? LoadCamera(store, manifest, sensor)
                                                                      : LoadTable(store, manifest, sensor));
  inputs.side.sensor = sensor;
  return inputs;
}

using calib::TrackerLidarCapture;
using calib::TrackerLidarProblem;

// Boards of one plate look alike to a lidar: one of them is searched for.
std::vector<const Target*> OfDifferentPlates(const SessionHeader& header, const Sensor& lidar) {
  std::vector<const Target*> different;
  std::set<std::string> keys;
  for (const Target* target : CommonTargets(header, lidar, lidar))
    if (keys.insert(detect::CloudDetectorKey(*target)).second) different.push_back(target);
  return different;
}

std::string Words(const CloudView& view) {
  const std::string note = view.note.empty() ? "" : "; " + view.note;
  if (!view.found) return view.why_not + note;
  const std::size_t count = view.candidates.size();
  return std::to_string(count) + (count == 1 ? " patch that may be a board" : " patches that may be a board") + note;
}

Status AddClouds(storage::Store& store, const Manifest& manifest, const SensorId& lidar, const Target& target,
                 std::map<CaptureId, TrackerLidarCapture>& captures, std::vector<Evidence>& evidence, OddClouds& odd) {
  RIGCAL_ASSIGN(auto clouds, DetectInClouds(store, manifest, lidar, target));
  for (auto& [capture, seen] : clouds) {
    if (!seen.picture.empty())
      evidence.push_back({EvidenceTitle(lidar, capture, Words(seen.view)), lidar, capture, seen.picture, "jpg"});
    odd.Add(lidar, capture, seen.view.note);
    captures[capture].clouds.push_back(std::move(seen.view));
  }
  return {};
}

}  // namespace

Result<PoseTable> LoadPoses(storage::Store& store, const Manifest& manifest, const Sensor& sensor) {
  RIGCAL_ASSIGN(const PoseFile file, LoadPoseFile(store, manifest, sensor));
  if (sensor.kind == SensorKind::kTracker)
    return formats::ReadPosesOf(OtherCaptures(manifest, sensor.id), file.text, file.path);
  return formats::ReadPoses(file.text, sensor.kind, file.path);
}

Result<PoseTable> LoadTrackerPath(storage::Store& store, const Manifest& manifest, const Sensor& tracker) {
  RIGCAL_ASSIGN(const PoseFile file, LoadPoseFile(store, manifest, tracker));
  return formats::ReadTrackerPath(file.text, file.path);
}

Result<PairInputs<calib::HandEyeProblem>> LoadHandEye(storage::Store& store, const Manifest& manifest,
                                                      const SensorPair& pair, Method method) {
  RIGCAL_ASSIGN(const SensorsOfPair sensors, FindSensors(manifest.header, pair));
  RIGCAL_ASSIGN(SideInputs a, LoadSide(store, manifest, *sensors.a));
  RIGCAL_ASSIGN(SideInputs b, LoadSide(store, manifest, *sensors.b));
  PairInputs<calib::HandEyeProblem> inputs;
  inputs.evidence = std::move(a.evidence);
  inputs.evidence.insert(inputs.evidence.end(), b.evidence.begin(), b.evidence.end());
  std::stable_sort(inputs.evidence.begin(), inputs.evidence.end(),
                   [](const Evidence& x, const Evidence& y) { return x.capture < y.capture; });
  inputs.problem.method = method;
  inputs.problem.T_a_b_nominal = NominalPose(manifest.header, a.side.sensor, b.side.sensor);
  inputs.problem.a = std::move(a.side);
  inputs.problem.b = std::move(b.side);
  return inputs;
}

Result<PairInputs<TrackerLidarProblem>> LoadTrackerLidar(storage::Store& store, const Manifest& manifest,
                                                         const SensorPair& pair) {
  RIGCAL_ASSIGN(const SensorsOfPair sensors, FindSensors(manifest.header, pair));
  PairInputs<TrackerLidarProblem> inputs;
  TrackerLidarProblem& problem = inputs.problem;
  problem.tracker_is_a = sensors.a->kind == SensorKind::kTracker;
  problem.tracker = problem.tracker_is_a ? *sensors.a : *sensors.b;
  problem.lidar = problem.tracker_is_a ? *sensors.b : *sensors.a;
  problem.T_body_lidar_nominal = NominalPose(manifest.header, problem.tracker, problem.lidar);
  RIGCAL_ASSIGN(const PoseTable poses, LoadPoses(store, manifest, problem.tracker));
  std::map<CaptureId, TrackerLidarCapture> captures;
  OddClouds odd;
  for (const Target* target : OfDifferentPlates(manifest.header, problem.lidar)) {
    problem.boards.push_back(*target);
    RIGCAL_TRY(AddClouds(store, manifest, problem.lidar.id, *target, captures, inputs.evidence, odd));
  }
  inputs.notes = odd.Notes();
  for (const TimedPose& pose : poses) captures[pose.capture].T_world_body = pose.T_world_body;
  for (auto& [id, capture] : captures) {
    capture.capture = id;
    problem.captures.push_back(std::move(capture));
  }
  std::stable_sort(inputs.evidence.begin(), inputs.evidence.end(),
                   [](const Evidence& x, const Evidence& y) { return x.capture < y.capture; });
  return inputs;
}

}  // namespace rigcal::pipeline
