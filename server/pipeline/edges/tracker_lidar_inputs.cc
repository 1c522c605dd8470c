#include <algorithm>
#include <map>
#include <set>

#include "server/detect/clouds/cloud_board.h"
#include "server/pipeline/edges/odd_clouds.h"
#include "server/pipeline/edges/pair_inputs.h"
#include "server/pipeline/edges/pose_inputs.h"

namespace rigcal::pipeline {
namespace {

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
