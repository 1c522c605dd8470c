// rig.yaml: which topic of a bag is which sensor. It is session.yaml without `captured_at`, and with a `topic` for each
// sensor; the same file serves every bag of that rig (docs/bags.md).
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "client/import/survey.h"
#include "server/base/stamp.h"
#include "server/formats/yaml/yaml_field.h"
#include "server/model/sessions/session.h"

namespace rigcal::importing {

enum class StampSource { kHeader, kLog };  // the driver's stamp, or the time when the message was recorded

struct MappedSensor {
  SensorId id;
  SensorKind kind = SensorKind::kCamera;
  std::string topic;
  std::string frame, child_frame;  // of a topic of transforms: whose pose is wanted, and in which frame
  StampSource stamp = StampSource::kHeader;
  std::optional<double> clock_offset_s;  // stated: its stamps minus those that the rig's clock would give
};

// Of a stream: its still moments; of messages all that have partners. kAuto: as the bag is (stream_kind.h).
enum class MomentsWanted { kAuto, kAll, kStill };

struct RigMap {
  std::vector<MappedSensor> sensors;      // in the file's order
  std::int64_t tolerance_ns = 5'000'000;  // messages whose stamps are at most so far apart are one capture
  std::int64_t every_ns = 0;              // captures are at least so far apart
  MomentsWanted moments = MomentsWanted::kAuto;
  double motion_px = 0.5, motion_m = 0.001;  // that a still moment may move by, in the picture and on the board
  formats::YamlNode session;                 // what goes into session.yaml
  SessionHeader header;                      // as a session of it would be read, but for its time
};

// `name` starts every error. Refuses what session.yaml would refuse, sensors without a topic, and two sensors of one
// topic and frame.
[[nodiscard]] Result<RigMap> ReadRigMap(std::string_view text, const std::string& name);
// Tells something of the session under `conditions`.
void AddCondition(const std::string& name, const std::string& text, RigMap& map);
// session.yaml of a bag that begins then.
[[nodiscard]] std::string SessionYaml(const RigMap& map, Stamp captured_at);
// A first rig.yaml of this bag, for a person to edit: every topic that may be a sensor is one, named after it. What
// cannot be known from the bag (the robot's id, the boards) is left open and asked for.
[[nodiscard]] std::string FirstRigYaml(const BagSurvey& survey);

}  // namespace rigcal::importing
