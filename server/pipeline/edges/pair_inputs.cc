#include "server/pipeline/edges/pair_inputs.h"

#include <algorithm>

#include "server/pipeline/edges/sightings.h"

namespace rigcal::pipeline {
namespace {

struct Pair {
  const Sensor *a, *b;
  std::vector<const Target*> targets;
};

Result<Pair> PairOf(const SessionHeader& header, const SensorPair& ids) {
  RIGCAL_ASSIGN(const SensorsOfPair sensors, FindSensors(header, ids));
  Pair pair{sensors.a, sensors.b, CommonTargets(header, *sensors.a, *sensors.b)};
  if (pair.targets.empty())
    return Fail(ErrorCode::kInvalidInput, "no target can be seen by both " + ids.a.str() + " and " + ids.b.str(),
                "Name the target that both look at under 'sees' in session.yaml.");
  return pair;
}

std::string Words(const storage::StoredView& seen) {
  return seen.view.found ? std::to_string(seen.view.corners_px.size()) + " corners" : seen.view.why_not;
}

std::string Words(const storage::StoredCloud& seen) {
  const std::string note = seen.view.note.empty() ? "" : "; " + seen.view.note;
  if (!seen.view.found) return seen.view.why_not + note;
  const std::size_t count = seen.view.candidates.size();
  return std::to_string(count) + (count == 1 ? " patch that may be the board" : " patches that may be the board") +
         note;
}

std::vector<Diagnosis> NotesOf(const SensorId& lidar, const Sightings<storage::StoredCloud>& clouds) {
  OddClouds odd;
  for (const auto& [capture, seen] : clouds) odd.Add(lidar, capture, seen.view.note);
  return odd.Notes();
}

// Evidence of both sensors by capture; `order` puts sensor a before sensor b.
using EvidenceMap = std::map<std::pair<CaptureId, int>, Evidence>;

template <typename Stored>
void AddEvidence(const SensorId& sensor, const Sightings<Stored>& sightings, int order, EvidenceMap& evidence) {
  for (const auto& [capture, seen] : sightings)
    if (!seen.picture.empty())
      evidence[{capture, order}] = {EvidenceTitle(sensor, capture, Words(seen)), sensor, capture, seen.picture, "jpg"};
}

std::vector<Evidence> ListOf(EvidenceMap map) {
  std::vector<Evidence> list;
  for (auto& [key, item] : map) list.push_back(std::move(item));
  return list;
}

template <typename Capture, typename A, typename B, typename ViewA, typename ViewB>
std::vector<Capture> Joined(const Sightings<A>& a, ViewA Capture::*view_a, const Sightings<B>& b,
                            ViewB Capture::*view_b) {
  std::map<CaptureId, Capture> captures;
  for (const auto& [id, seen] : a) captures[id].*view_a = seen.view;
  for (const auto& [id, seen] : b) captures[id].*view_b = seen.view;
  std::vector<Capture> list;
  for (auto& [id, capture] : captures) {
    capture.capture = id;
    list.push_back(std::move(capture));
  }
  return list;
}

std::size_t SeenByBoth(const calib::StereoProblem& problem) {
  return static_cast<std::size_t>(std::count_if(problem.captures.begin(), problem.captures.end(),
                                                [](const auto& c) { return c.a && c.b && c.a->found && c.b->found; }));
}

std::size_t SeenByBoth(const calib::LidarCameraProblem& problem) {
  return static_cast<std::size_t>(std::count_if(problem.captures.begin(), problem.captures.end(), [](const auto& c) {
    return c.view && c.cloud && c.view->found && c.cloud->found;
  }));
}

template <typename Problem, typename LoadOne>
Result<PairInputs<Problem>> BestOf(const Pair& pair, const LoadOne& load_one) {
  std::optional<PairInputs<Problem>> best;
  for (const Target* target : pair.targets) {
    RIGCAL_ASSIGN(PairInputs<Problem> inputs, load_one(*target));
    if (!best || SeenByBoth(inputs.problem) > SeenByBoth(best->problem)) best = std::move(inputs);
  }
  return std::move(*best);
}

}  // namespace

Result<SensorsOfPair> FindSensors(const SessionHeader& header, const SensorPair& pair) {
  const SensorsOfPair sensors{SensorOf(header, pair.a), SensorOf(header, pair.b)};
  if (sensors.a != nullptr && sensors.b != nullptr) return sensors;
  return Fail(ErrorCode::kInternal, "the session has no sensor '" + (sensors.a ? pair.b : pair.a).str() + "'",
              "Push the session again under its own manifest.");
}

Result<PairInputs<calib::StereoProblem>> LoadStereo(storage::Store& store, const Manifest& manifest,
                                                    const SensorPair& ids) {
  RIGCAL_ASSIGN(const Pair pair, PairOf(manifest.header, ids));
  return BestOf<calib::StereoProblem>(pair, [&](const Target& target) -> Result<PairInputs<calib::StereoProblem>> {
    RIGCAL_ASSIGN(const auto a, DetectInImages(store, manifest, ids.a, target));
    RIGCAL_ASSIGN(const auto b, DetectInImages(store, manifest, ids.b, target));
    EvidenceMap evidence;
    AddEvidence(ids.a, a, 0, evidence);
    AddEvidence(ids.b, b, 1, evidence);
    using Capture = calib::StereoCapture;
    return PairInputs<calib::StereoProblem>{
        {*pair.a, *pair.b, target, Joined<Capture>(a, &Capture::a, b, &Capture::b)}, ListOf(std::move(evidence)), {}};
  });
}

Result<PairInputs<calib::LidarCameraProblem>> LoadLidarCamera(storage::Store& store, const Manifest& manifest,
                                                              const SensorPair& ids) {
  RIGCAL_ASSIGN(const Pair pair, PairOf(manifest.header, ids));
  const bool camera_is_a = pair.a->kind == SensorKind::kCamera;
  const Sensor &camera = camera_is_a ? *pair.a : *pair.b, &lidar = camera_is_a ? *pair.b : *pair.a;
  return BestOf<calib::LidarCameraProblem>(
      pair, [&](const Target& target) -> Result<PairInputs<calib::LidarCameraProblem>> {
        RIGCAL_ASSIGN(const auto views, DetectInImages(store, manifest, camera.id, target));
        RIGCAL_ASSIGN(const auto clouds, DetectInClouds(store, manifest, lidar.id, target));
        EvidenceMap evidence;
        AddEvidence(camera.id, views, camera_is_a ? 0 : 1, evidence);
        AddEvidence(lidar.id, clouds, camera_is_a ? 1 : 0, evidence);
        using Capture = calib::LidarCameraCapture;
        calib::LidarCameraProblem problem{
            camera,      lidar, target, Joined<Capture>(views, &Capture::view, clouds, &Capture::cloud),
            camera_is_a, 0.0,   {}};
        problem.T_cam_lidar_nominal = NominalPose(manifest.header, camera, lidar);
        return PairInputs<calib::LidarCameraProblem>{std::move(problem), ListOf(std::move(evidence)),
                                                     NotesOf(lidar.id, clouds)};
      });
}

}  // namespace rigcal::pipeline
