#include "server/pipeline/pose_inputs.h"

#include <algorithm>
#include <set>

#include "server/base/limits.h"
#include "server/formats/poses.h"
#include "storage/blobs.h"

namespace rigcal::pipeline {
namespace {

std::set<CaptureId> OtherCaptures(const Manifest& manifest, const SensorId& tracker) {
  std::set<CaptureId> captures;
  for (const Payload& payload : manifest.payloads)
    if (payload.sensor != tracker) captures.insert(payload.capture);
  return captures;
}

}  // namespace

Result<PoseTable> LoadPoses(storage::Store& store, const Manifest& manifest, const Sensor& sensor) {
  const auto payload = std::find_if(manifest.payloads.begin(), manifest.payloads.end(),
                                    [&](const Payload& p) { return p.sensor == sensor.id; });
  if (payload == manifest.payloads.end())
    return Fail(ErrorCode::kNotFound, "sensor " + sensor.id.str() + " has no poses.csv",
                "Put its poses into " + sensor.id.str() + "/poses.csv and push the session again.");
  const auto text = storage::LoadBlob(store.BlobFolder(), payload->digest, limits::kPoseTableBytesMax);
  // A damaged disk costs this sensor, not the robot.
  if (!text) return Fail(ErrorCode::kInvalidInput, text.error().what, text.error().cure);
  if (sensor.kind == SensorKind::kTracker)
    return formats::ReadPosesOf(OtherCaptures(manifest, sensor.id), *text, payload->path);
  return formats::ReadPoses(*text, sensor.kind, payload->path);
}

}  // namespace rigcal::pipeline
