// Why something could not be done, or not trusted, in words a technician can act on.
#pragma once

#include <string>

namespace rigcal {

// `code` is stable and machine-readable ("too_few_captures"); `what` names the thing; `cure` says what to do.
struct Diagnosis {
  std::string code;
  std::string what;
  std::string cure;
  friend bool operator==(const Diagnosis&, const Diagnosis&) = default;
};

enum class VerdictLevel { kUnknown, kPass, kWarn, kFail };  // "unknown" | "pass" | "warn" | "fail"
struct Verdict {
  VerdictLevel level = VerdictLevel::kUnknown;
  std::string why;         // one plain sentence
  std::string what_to_do;  // one plain sentence
};
[[nodiscard]] std::string NameOf(VerdictLevel level);
[[nodiscard]] VerdictLevel VerdictLevelOf(const std::string& name);

}  // namespace rigcal
