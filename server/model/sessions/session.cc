#include "server/model/sessions/session.h"

#include <algorithm>
#include <map>
#include <set>

#include "server/base/limits.h"
#include "server/base/text.h"
#include "server/model/named.h"

namespace rigcal {
namespace {

Status CheckText(const std::string& field, const std::string& text) {
  constexpr std::size_t kTextBytesMax = 1024;
  if (text.size() <= kTextBytesMax && IsPrintableUtf8(text)) return {};
  return Fail(ErrorCode::kInvalidInput, field + ": " + Quoted(text) + " is not one line of readable text",
              "Use at most " + std::to_string(kTextBytesMax) + " bytes of UTF-8 without control characters.");
}

bool HasSensor(const SessionHeader& header, const SensorId& id) {
  return std::any_of(header.sensors.begin(), header.sensors.end(), [&](const Sensor& s) { return s.id == id; });
}

bool HasTarget(const SessionHeader& header, const TargetId& id) {
  return std::any_of(header.targets.begin(), header.targets.end(), [&](const Target& t) { return t.id == id; });
}

Status CheckTexts(const SessionHeader& header) {
  RIGCAL_TRY(CheckText("rig_model", header.rig_model));
  RIGCAL_TRY(CheckText("operator", header.operator_name));
  for (const auto& [key, value] : header.conditions) {
    RIGCAL_TRY(CheckText("conditions", key));
    RIGCAL_TRY(CheckText("conditions " + key, value));
  }
  return {};
}

Status CheckCount(const std::string& things, std::size_t count, std::size_t count_max) {
  if (count >= 1 && count <= count_max) return {};
  return Fail(ErrorCode::kInvalidInput, things + ": the session has " + std::to_string(count),
              "Give 1 to " + std::to_string(count_max) + ".");
}

// Pictures show a target; poses by themselves need none.
Status CheckTargetCount(const SessionHeader& header) {
  const bool any_camera = std::any_of(header.sensors.begin(), header.sensors.end(),
                                      [](const Sensor& sensor) { return sensor.kind == SensorKind::kCamera; });
  if (header.targets.empty() && !any_camera) return {};
  return CheckCount("targets", header.targets.size(), limits::kTargetsPerSessionMax);
}

Status CheckSkipPair(const SessionHeader& header, const SensorPair& pair) {
  const auto has = [&](const SensorId& id) { return HasSensor(header, id); };
  return CheckPairIn("skip_pairs", pair, has, "a sensor", "Name two of the session's sensors.");
}

Status CheckSkipPairs(const SessionHeader& header) {
  constexpr std::size_t kSkipPairsMax = 65'536;
  if (header.skip_pairs.size() > kSkipPairsMax)
    return Fail(ErrorCode::kInvalidInput,
                "skip_pairs: the session has " + std::to_string(header.skip_pairs.size()) + " of them",
                "Give at most " + std::to_string(kSkipPairsMax) + ".");
  for (const SensorPair& pair : header.skip_pairs) RIGCAL_TRY(CheckSkipPair(header, pair));
  return {};
}

// A session without any pair of such a sensor would begin no work, and so change nothing.
Status CheckRemounted(const SessionHeader& header) {
  if (header.remounted.empty()) return {};
  std::set<SensorId> measured;
  for (const SensorPair& pair : PairsToCalibrate(header)) measured.insert({pair.a, pair.b});
  for (const SensorId& id : header.remounted) {
    if (!HasSensor(header, id))
      return Fail(ErrorCode::kInvalidInput, "remounted: " + Quoted(id.str()) + " is not a sensor",
                  "Name sensors of the session, which measures them anew.");
    if (!measured.contains(id))
      return Fail(
          ErrorCode::kInvalidInput, "remounted: " + Quoted(id.str()) + " is in no pair that is calibrated",
          "Name it in a session that measures it anew, with a sensor that sees the same target or moves along.");
  }
  return {};
}

// As remounted: what changes nothing was meant otherwise.
Status CheckLidarPolish(const SessionHeader& header) {
  if (header.lidar_polish == LidarPolish::kNone || HasLidarPair(header)) return {};
  return Fail(ErrorCode::kInvalidInput,
              "lidar_polish: the session has no two lidars that are calibrated with each other",
              "Leave it away, or list both lidars and keep their pair out of skip_pairs.");
}

Status CheckReference(const SessionHeader& header) {
  if (HasSensor(header, header.reference)) return {};
  return Fail(ErrorCode::kInvalidInput, "reference sensor " + Quoted(header.reference.str()) + " is not a sensor",
              "Name one of the session's sensors as the reference.");
}

Status CheckSightings(const SessionHeader& header) {
  for (const Sensor& sensor : header.sensors)
    if (sensor.sees && !HasTarget(header, *sensor.sees))
      return Fail(ErrorCode::kInvalidInput,
                  "sensor " + sensor.id.str() + ": it sees target " + Quoted(sensor.sees->str()) +
                      ", which the session does not list",
                  "List the target, or leave 'sees' away if any target may be seen.");
  return {};
}

Status CheckCarrier(const SessionHeader& header, const Target& target) {
  if (!target.mounted_on) return {};
  const Sensor* carrier = SensorOf(header, *target.mounted_on);
  if (carrier != nullptr && carrier->kind == SensorKind::kTracker) return {};
  return Fail(ErrorCode::kInvalidInput,
              "target " + target.id.str() + ": it is mounted on " + Quoted(target.mounted_on->str()) +
                  (carrier == nullptr ? ", which is not a sensor" : ", which is a " + NameOf(carrier->kind)),
              "Name the tracker whose poses.csv tells where the body is that carries the board (a robot's flange); "
              "leave 'mounted_on' away if the board stands still.");
}

// Which of two boards a sensor sees decides what its pair with the tracker means.
Status CheckOneCarrier(const SessionHeader& header, const Sensor& sensor) {
  const bool looks = sensor.kind == SensorKind::kCamera || sensor.kind == SensorKind::kLidar;
  if (!looks || sensor.sees || header.targets.empty()) return {};
  const Target& first = header.targets.front();
  const auto other = std::find_if(header.targets.begin(), header.targets.end(),
                                  [&](const Target& target) { return target.mounted_on != first.mounted_on; });
  if (other == header.targets.end()) return {};
  const auto words = [](const Target& target) {
    return Quoted(target.id.str()) +
           (target.mounted_on ? ", which moves with " + target.mounted_on->str() : ", which stands still");
  };
  return Fail(ErrorCode::kInvalidInput,
              "sensor " + sensor.id.str() + ": it may see target " + words(first) + ", and target " + words(*other),
              "Say which of them it looks at: 'sees: " + first.id.str() + "' or 'sees: " + other->id.str() + "'.");
}

Status CheckMounts(const SessionHeader& header) {
  for (const Target& target : header.targets) RIGCAL_TRY(CheckCarrier(header, target));
  for (const Sensor& sensor : header.sensors) RIGCAL_TRY(CheckOneCarrier(header, sensor));
  return {};
}

// Names are ASCII (CheckName).
std::string InLowerCase(std::string name) {
  for (char& c : name)
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
  return name;
}

template <typename T>
Status CheckUnique(const std::string& kind, const std::vector<T>& things) {
  std::map<std::string, std::string> seen;
  for (const T& thing : things) {
    const auto [other, is_new] = seen.emplace(InLowerCase(thing.id.str()), thing.id.str());
    if (is_new) continue;
    const bool same = other->second == thing.id.str();
    return Fail(
        ErrorCode::kInvalidInput,
        kind + " " + thing.id.str() + (same ? " is listed twice" : " differs from " + other->second + " only in case"),
        "Give every " + kind + " its own name; not every disk tells upper from lower case.");
  }
  return {};
}

}  // namespace

std::string NameOf(SensorKind kind) {
  switch (kind) {
    case SensorKind::kCamera:
      return "camera";
    case SensorKind::kLidar:
      return "lidar";
    case SensorKind::kTracker:
      return "tracker";
    case SensorKind::kPoseStream:
      return "pose_stream";
  }
  return "camera";
}

Result<SensorKind> SensorKindOf(const std::string& name) {
  return ValueNamed(name, {SensorKind::kCamera, SensorKind::kLidar, SensorKind::kTracker, SensorKind::kPoseStream},
                    "sensor kind", "Use camera, lidar, tracker or pose_stream.");
}

std::string NameOf(LidarPolish polish) { return polish == LidarPolish::kGicp ? "gicp" : "none"; }

Result<LidarPolish> LidarPolishOf(const std::string& name) {
  return ValueNamed(name, {LidarPolish::kNone, LidarPolish::kGicp}, "polish",
                    "Use gicp (generalised ICP after NDT), or none, as if it were left away.");
}

Status Validate(const SessionHeader& header) {
  if (header.format != 1)
    return Fail(ErrorCode::kUnsupported, "session format " + std::to_string(header.format) + " is not known",
                "This version reads format 1; update Rigcal if the session is newer.");
  RIGCAL_TRY(CheckName(RobotTag::kKind, header.robot.str()));
  RIGCAL_TRY(CheckTexts(header));
  if (header.captured_at.ns < 0)
    return Fail(ErrorCode::kInvalidInput, "captured_at lies before 1970", "Give the time of the capture.");
  RIGCAL_TRY(CheckCount("sensors", header.sensors.size(), limits::kSensorsPerSessionMax));
  RIGCAL_TRY(CheckTargetCount(header));
  for (const Target& target : header.targets) RIGCAL_TRY(Validate(target));
  RIGCAL_TRY(CheckUnique("target", header.targets));
  for (const Sensor& sensor : header.sensors) RIGCAL_TRY(Validate(sensor));
  RIGCAL_TRY(CheckUnique("sensor", header.sensors));
  RIGCAL_TRY(CheckSightings(header));
  RIGCAL_TRY(CheckMounts(header));
  RIGCAL_TRY(CheckSkipPairs(header));
  RIGCAL_TRY(CheckReference(header));
  RIGCAL_TRY(CheckRemounted(header));
  return CheckLidarPolish(header);
}

Status CheckBoardsApart(const SessionHeader& header) {
  for (const Sensor& sensor : header.sensors) {
    if (sensor.kind != SensorKind::kCamera || sensor.sees) continue;
    for (auto a = header.targets.begin(); a != header.targets.end(); ++a)
      for (auto b = a + 1; b != header.targets.end(); ++b)
        if (LookAlike(*a, *b))
          return Fail(ErrorCode::kInvalidInput,
                      "camera " + sensor.id.str() + " may see targets " + Quoted(a->id.str()) + " and " +
                          Quoted(b->id.str()) + ", which look alike in a picture",
                      MarkerCountOf(*a) > 0 ? "Print one of them with other ids (first_id), or say which of them the "
                                              "camera looks at: 'sees: " +
                                                  a->id.str() + "'."
                                            : "Say which of them the camera looks at: 'sees: " + a->id.str() +
                                                  "'; or take boards with markers of different ids.");
  }
  return {};
}

const Sensor* SensorOf(const SessionHeader& header, const SensorId& id) { return FindById(header.sensors, id); }

std::optional<CloudLayout> LayoutOf(const SessionHeader& header, const SensorId& lidar) {
  const Sensor* sensor = SensorOf(header, lidar);
  return sensor == nullptr ? std::nullopt : sensor->layout;
}

std::vector<CaptureId> RecordedCaptures(const Manifest& manifest) {
  std::set<CaptureId> captures;
  for (const Payload& payload : manifest.payloads) {
    const Sensor* sensor = SensorOf(manifest.header, payload.sensor);
    if (sensor != nullptr && (sensor->kind == SensorKind::kCamera || sensor->kind == SensorKind::kLidar))
      captures.insert(payload.capture);
  }
  return {captures.begin(), captures.end()};
}

}  // namespace rigcal
