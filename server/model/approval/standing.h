// Which of several sessions of the same pictures counts, what was retired, and who said so.
#pragma once

#include <cstdint>
#include <string>

#include "server/base/ids.h"
#include "server/base/stamp.h"

namespace rigcal {

// Who says something, when and why. The texts are one printable line of at most 500 bytes; `reason` may be empty.
struct Word {
  Stamp at;
  std::string who, reason;
  friend bool operator==(const Word&, const Word&) = default;
};

// The word by which a session is current, or was last, or by which a session, an edge or a sensor was retired or
// restored.
struct Standing {
  std::int64_t number = 0;  // order of arrival among those of all robots
  std::string how;          // "pushed" (it came whole), "pushed_again", "restored", "retired"
  Word word;
};

// A closed session by which another is superseded.
struct Superseding {
  SessionId by;
  Stamp captured_at;
  std::string operator_name;
  Standing standing;  // of `by`: since when
};

// A sensor that is gone from the robot, as somebody said.
struct RetiredSensor {
  SensorId sensor;
  Word word;
  friend bool operator==(const RetiredSensor&, const RetiredSensor&) = default;
};

// For people, without a stop at the end: "retired on 2026-01-31 by Ada: typed 1.2 for 0.12".
[[nodiscard]] std::string RetiredText(const Word& word);
// "front_left was retired on 2026-01-31 by Ada: taken off".
[[nodiscard]] std::string RetiredText(const RetiredSensor& gone);

// What a person types: to take it out (the reason is for the person to fill in), and to bring it back. Ids are cut to
// the digits that name a thing among all that there are.
[[nodiscard]] std::string RetireCommand(const EdgeId& edge);
[[nodiscard]] std::string RetireCommand(const SessionId& session);
[[nodiscard]] std::string RetireCommand(const RobotId& robot, const SensorId& sensor);
[[nodiscard]] std::string RestoreCommand(const EdgeId& edge);
[[nodiscard]] std::string RestoreCommand(const SessionId& session);
[[nodiscard]] std::string RestoreCommand(const RobotId& robot, const SensorId& sensor);
// "`rigcal restore front_left --robot mapper-01` brings it back."
[[nodiscard]] std::string BringsBack(const std::string& restore_command);

}  // namespace rigcal
