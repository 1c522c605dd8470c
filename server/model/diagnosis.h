// Why something could not be done, or not trusted, in words a technician can act on.
#pragma once

#include <map>
#include <string>

namespace rigcal {

// `code` is stable and machine-readable ("too_few_captures"); `what` names the thing; `cure` says what to do.
struct Diagnosis {
  std::string code;
  std::string what;
  std::string cure;
  // Numbers behind the sentences, by name and unit ("board_tilt_rad"), on their way to the figures of an edge: an edge,
  // the store and documents hold them there alone.
  std::map<std::string, double> figures = {};
  friend bool operator==(const Diagnosis&, const Diagnosis&) = default;
};

enum class VerdictLevel { kUnknown, kPass, kWarn, kFail };  // "unknown" | "pass" | "warn" | "fail"
struct Verdict {
  VerdictLevel level = VerdictLevel::kUnknown;
  std::string why;         // one plain sentence
  std::string what_to_do;  // one plain sentence
  // Of an unknown one: the sensors that are not to be relied on, as a sentence names them; empty: all of the robot.
  std::string unverified = {};
};
// "unknown" | "pass" | "warn" | "fail", and back; any other name is unknown.
[[nodiscard]] std::string NameOf(VerdictLevel level);
[[nodiscard]] VerdictLevel VerdictLevelOf(const std::string& name);

}  // namespace rigcal
