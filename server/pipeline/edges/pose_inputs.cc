#include "server/pipeline/edges/pose_inputs.h"

#include <algorithm>
#include <set>

#include "server/base/limits.h"
#include "server/formats/sessions/poses.h"
#include "server/pipeline/edges/lost_payloads.h"

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
  RIGCAL_ASSIGN(std::string text, LoadPayload(store.BlobFolder(), *payload, limits::kPoseTableBytesMax));
  return PoseFile{std::move(text), payload->path};
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

}  // namespace rigcal::pipeline
