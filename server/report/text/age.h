// How long ago, and how long it may be, in words.
#pragma once

#include <string>

#include "server/report/render.h"

namespace rigcal::report {

// "12 days ago"; of what lies in the future, that the clock should be checked.
[[nodiscard]] std::string AgeOf(Stamp then, Stamp now);
// Not calibrated yet: no revision, or one of failed edges only.
[[nodiscard]] bool IsNever(const RobotSummary& robot);
// "limit 90 days: 21 Feb 2027"; the day is left out where nothing is calibrated.
[[nodiscard]] std::string AgeLimitText(const Validity& validity);

}  // namespace rigcal::report
