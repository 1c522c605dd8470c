#include "server/model/diagnosis.h"

namespace rigcal {

std::string NameOf(VerdictLevel level) {
  switch (level) {
    case VerdictLevel::kUnknown:
      return "unknown";
    case VerdictLevel::kPass:
      return "pass";
    case VerdictLevel::kWarn:
      return "warn";
    case VerdictLevel::kFail:
      return "fail";
  }
  return "unknown";
}

VerdictLevel VerdictLevelOf(const std::string& name) {
  for (VerdictLevel level : {VerdictLevel::kPass, VerdictLevel::kWarn, VerdictLevel::kFail})
    if (NameOf(level) == name) return level;
  return VerdictLevel::kUnknown;
}

}  // namespace rigcal
