#include <algorithm>
#include <set>
#include <unordered_map>
#include <utility>

#include "server/base/limits.h"
#include "server/base/text.h"
#include "server/model/sessions/session.h"

namespace rigcal {
namespace {

Status Refuse(const Payload& payload, const std::string& what, const std::string& cure) {
  return Fail(ErrorCode::kInvalidInput, "file " + Quoted(payload.path) + ": " + what, cure);
}

struct PathRule {
  const char *form, *suffix;  // what a path must look like, and an example's end
};
PathRule RuleOf(SensorKind kind) {
  if (kind == SensorKind::kCamera) return {"<sensor>/<capture>.png, .jpg or .jpeg", ".png"};
  if (kind == SensorKind::kLidar) return {"<sensor>/<capture>.pcd, .ply or .bin", ".pcd"};
  return {"<sensor>/poses.csv", ".csv"};
}

// The path follows from sensor and capture: what could leave the session's folder cannot be written down at all.
Status CheckPath(const Payload& payload, SensorKind kind) {
  const bool table = kind == SensorKind::kTracker || kind == SensorKind::kPoseStream;
  const std::string stem = payload.sensor.str() + "/" + (table ? std::string(kPoseTableStem) : payload.capture.str());
  for (std::string_view suffix : SuffixesOf(kind))
    if (payload.path == stem + "." + std::string(suffix) && (!table || payload.capture.str() == kPoseTableStem))
      return {};
  const PathRule rule = RuleOf(kind);
  return Refuse(
      payload, std::string("the path is not ") + rule.form,
      (table ? "Name the file " : "Name the file after its sensor and capture: ") + Quoted(stem + rule.suffix) + ".");
}

Status CheckPayload(const Payload& payload, const std::unordered_map<SensorId, SensorKind>& sensors) {
  RIGCAL_TRY(CheckName(SensorTag::kKind, payload.sensor.str()));
  RIGCAL_TRY(CheckName(CaptureTag::kKind, payload.capture.str()));
  const auto sensor = sensors.find(payload.sensor);
  if (sensor == sensors.end())
    return Refuse(payload, "sensor " + payload.sensor.str() + " is not in the session",
                  "List the sensor in session.yaml or remove its folder.");
  RIGCAL_TRY(CheckPath(payload, sensor->second));
  RIGCAL_TRY(CheckDigest("sha256 of " + Quoted(payload.path), payload.digest.str()));
  if (payload.size_bytes < 1) return Refuse(payload, "it is empty", "Record it again or remove it.");
  if (payload.size_bytes > limits::kPayloadBytesMax)
    return Refuse(payload, "it is larger than " + std::to_string(limits::kPayloadBytesMax) + " bytes",
                  "Store the capture in a smaller file.");
  return {};
}

Status CheckOrder(const std::vector<Payload>& payloads) {
  const auto later = std::adjacent_find(payloads.begin(), payloads.end(),
                                        [](const Payload& a, const Payload& b) { return !(a.path < b.path); });
  if (later == payloads.end()) return {};
  return Refuse(*later, "it is listed twice or out of order", "Sort the payloads by path and list each once.");
}

Status CheckOneFilePerCapture(const std::vector<Payload>& payloads) {
  std::set<std::pair<std::string_view, std::string_view>> seen;
  for (const Payload& payload : payloads)
    if (!seen.emplace(payload.sensor.str(), payload.capture.str()).second)
      return Refuse(payload,
                    "sensor " + payload.sensor.str() + " has another file for capture " + payload.capture.str(),
                    "Keep one of the two.");
  return {};
}

// No sum overflows: each size was checked against kPayloadBytesMax, their number against kPayloadsPerSessionMax.
Status CheckTotal(const std::vector<Payload>& payloads) {
  std::int64_t total_bytes = 0;
  for (const Payload& payload : payloads) total_bytes += payload.size_bytes;
  if (total_bytes <= limits::kSessionBytesMax) return {};
  return Fail(ErrorCode::kInvalidInput, "the session holds " + std::to_string(total_bytes) + " bytes",
              "Split it into sessions of at most " + std::to_string(limits::kSessionBytesMax) + " bytes.");
}

}  // namespace

const std::vector<std::string_view>& SuffixesOf(SensorKind kind) {
  static const std::vector<std::string_view> kPictures = {"png", "jpg", "jpeg"}, kClouds = {"pcd", "ply", "bin"},
                                             kTables = {"csv"};
  if (kind == SensorKind::kCamera) return kPictures;
  return kind == SensorKind::kLidar ? kClouds : kTables;
}

Status Validate(const Payload& payload, const SessionHeader& header) {
  const Sensor* sensor = SensorOf(header, payload.sensor);
  if (sensor == nullptr) return CheckPayload(payload, {});
  return CheckPayload(payload, {{sensor->id, sensor->kind}});
}

Status Validate(const Manifest& manifest) {
  RIGCAL_TRY(Validate(manifest.header));
  const std::size_t count = manifest.payloads.size();
  if (count < 1 || count > limits::kPayloadsPerSessionMax)
    return Fail(ErrorCode::kInvalidInput, "the session has " + std::to_string(count) + " files",
                "Give 1 to " + std::to_string(limits::kPayloadsPerSessionMax) + " captures.");
  std::unordered_map<SensorId, SensorKind> sensors;
  for (const Sensor& sensor : manifest.header.sensors) sensors.emplace(sensor.id, sensor.kind);
  for (const Payload& payload : manifest.payloads) RIGCAL_TRY(CheckPayload(payload, sensors));
  RIGCAL_TRY(CheckOrder(manifest.payloads));
  RIGCAL_TRY(CheckOneFilePerCapture(manifest.payloads));
  return CheckTotal(manifest.payloads);
}

}  // namespace rigcal
