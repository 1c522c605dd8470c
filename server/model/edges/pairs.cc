#include <algorithm>
#include <map>
#include <set>
#include <utility>

#include "server/model/edges/method.h"

namespace rigcal {
namespace {

bool MayShareTarget(const Sensor& a, const Sensor& b) { return !a.sees || !b.sees || *a.sees == *b.sees; }

bool MaySee(const Sensor& sensor, const Target& target) { return !sensor.sees || *sensor.sees == target.id; }

// A target that stands still, or, of a `carrier`, one that it carries.
bool MaySeeTarget(const SessionHeader& header, const Sensor& sensor, const std::optional<SensorId>& carrier = {}) {
  return std::any_of(header.targets.begin(), header.targets.end(),
                     [&](const Target& target) { return MaySee(sensor, target) && target.mounted_on == carrier; });
}

// What carries the target that a sensor sees, as far as it says which.
std::optional<SensorId> CarrierOfSeen(const SessionHeader& header, const Sensor& sensor) {
  for (const Target& target : header.targets)
    if (sensor.sees == target.id) return target.mounted_on;
  return std::nullopt;
}

// Whether sensors of the method's kinds, in its order, can be calibrated by it.
bool Applies(Method method, const SessionHeader& header, const Sensor& a, const Sensor& b) {
  switch (method) {
    case Method::kStereo:
    case Method::kLidarCamera:
      return MayShareTarget(a, b);
    case Method::kNonOverlapping:
      return !MayShareTarget(a, b) && CarrierOfSeen(header, a) == CarrierOfSeen(header, b);
    case Method::kTrackerCamera:
    case Method::kTrackerLidar:
      return !CarriesTarget(header, b.id) && MaySeeTarget(header, a);
    case Method::kEyeToHand:
      return MaySeeTarget(header, a, b.id);
    case Method::kLidarLidar:
    case Method::kPoseStreams:
      return true;
  }
  return false;
}

std::optional<Se3> DrawnPose(const SessionHeader& header, const Sensor& sensor) {
  return sensor.id == header.reference ? Se3{} : sensor.T_ref_nominal;
}

}  // namespace

std::optional<Method> MethodNamed(std::string_view name) {
  for (const MethodRow& row : kMethods)
    if (row.name == name) return row.method;
  return std::nullopt;
}

std::optional<Method> MethodFor(const SessionHeader& header, const Sensor& a, const Sensor& b) {
  if (b.kind < a.kind) return MethodFor(header, b, a);
  for (const MethodRow& row : kMethods)
    if (row.a == a.kind && row.b == b.kind && Applies(row.method, header, a, b)) return row.method;
  return std::nullopt;
}

bool CarriesTarget(const SessionHeader& header, const SensorId& tracker) {
  return std::any_of(header.targets.begin(), header.targets.end(),
                     [&](const Target& target) { return target.mounted_on == tracker; });
}

std::vector<const Target*> CommonTargets(const SessionHeader& header, const Sensor& a, const Sensor& b) {
  std::vector<const Target*> targets;
  for (const Target& target : header.targets)
    if (MaySee(a, target) && MaySee(b, target)) targets.push_back(&target);
  return targets;
}

std::vector<CaptureId> SamePictures(const Manifest& manifest, const SensorPair& pair) {
  std::map<CaptureId, Digest> of_a;
  for (const Payload& payload : manifest.payloads)
    if (payload.sensor == pair.a) of_a.emplace(payload.capture, payload.digest);
  std::vector<CaptureId> same;
  for (const Payload& payload : manifest.payloads) {
    if (payload.sensor != pair.b) continue;
    const auto other = of_a.find(payload.capture);
    if (other != of_a.end() && other->second == payload.digest) same.push_back(payload.capture);
  }
  return same;
}

std::vector<SensorPair> PairsToCalibrate(const SessionHeader& header) {
  std::set<std::pair<SensorId, SensorId>> skipped;  // whichever comes first; there may be tens of thousands
  for (const SensorPair& pair : header.skip_pairs) skipped.insert(std::minmax(pair.a, pair.b));
  std::vector<SensorPair> pairs;
  for (auto a = header.sensors.begin(); a != header.sensors.end(); ++a)
    for (auto b = a + 1; b != header.sensors.end(); ++b)
      if (MethodFor(header, *a, *b) && !skipped.contains(std::minmax(a->id, b->id))) pairs.push_back({a->id, b->id});
  return pairs;
}

bool IsSkipped(const SessionHeader& header, const SensorId& a, const SensorId& b) {
  return std::any_of(header.skip_pairs.begin(), header.skip_pairs.end(), [&](const SensorPair& pair) {
    return (pair.a == a && pair.b == b) || (pair.a == b && pair.b == a);
  });
}

bool HasLidarPair(const SessionHeader& header) {
  std::set<SensorId> lidars;
  for (const Sensor& sensor : header.sensors)
    if (sensor.kind == SensorKind::kLidar) lidars.insert(sensor.id);
  const std::vector<SensorPair> pairs = PairsToCalibrate(header);
  return std::any_of(pairs.begin(), pairs.end(),
                     [&](const SensorPair& pair) { return lidars.contains(pair.a) && lidars.contains(pair.b); });
}

std::optional<Se3> NominalPose(const SessionHeader& header, const Sensor& a, const Sensor& b) {
  const std::optional<Se3> T_ref_a = DrawnPose(header, a), T_ref_b = DrawnPose(header, b);
  if (!T_ref_a || !T_ref_b) return std::nullopt;
  return T_ref_a->Inverse() * *T_ref_b;
}

}  // namespace rigcal
