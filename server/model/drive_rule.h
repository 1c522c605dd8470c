// What a verdict means for who drives the robot: one line, and until when it holds.
#pragma once

#include <optional>
#include <string>

#include "server/base/stamp.h"
#include "server/model/diagnosis.h"
#include "server/model/validity.h"

namespace rigcal {

struct DriveRule {
  VerdictLevel level = VerdictLevel::kUnknown;  // that it stands for: what is overdue is no pass, but a warning
  std::string rule;                             // without a stop: "OK to drive until 20 Feb 2027"
  std::optional<Stamp> until = {};              // absent: no time ends it
};

// `due`: when the calibration is overdue; absent: it counts nothing, and is. Of a fail and of what is not known the
// time changes nothing.
[[nodiscard]] DriveRule DriveRuleOf(const Verdict& verdict, const std::optional<Stamp>& due, Stamp now);
// As of the moment at which `validity.overdue` was worked out. Of a superseded revision that it is: not known.
[[nodiscard]] DriveRule DriveRuleOf(const Verdict& verdict, const Validity& validity);

}  // namespace rigcal
