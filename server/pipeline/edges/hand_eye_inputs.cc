#include <algorithm>

#include "server/pipeline/edges/pair_inputs.h"
#include "server/pipeline/edges/pose_inputs.h"

namespace rigcal::pipeline {
namespace {

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

Result<SideInputs> LoadSide(storage::Store& store, const Manifest& manifest, const SensorId& id) {
  const Sensor* sensor = SensorOf(manifest.header, id);
  if (sensor == nullptr)
    return Fail(ErrorCode::kInternal, "the session has no sensor '" + id.str() + "'",
                "Push the session again under its own manifest.");
  RIGCAL_ASSIGN(SideInputs inputs, sensor->kind == SensorKind::kCamera ? LoadCamera(store, manifest, *sensor)
                                                                       : LoadTable(store, manifest, *sensor));
  inputs.side.sensor = *sensor;
  return inputs;
}

}  // namespace

Result<PairInputs<calib::HandEyeProblem>> LoadHandEye(storage::Store& store, const Manifest& manifest,
                                                      const SensorPair& pair, Method method) {
  RIGCAL_ASSIGN(SideInputs a, LoadSide(store, manifest, pair.a));
  RIGCAL_ASSIGN(SideInputs b, LoadSide(store, manifest, pair.b));
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

}  // namespace rigcal::pipeline
