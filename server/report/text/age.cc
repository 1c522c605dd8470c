#include "server/report/text/age.h"

namespace rigcal::report {

std::string AgeOf(Stamp then, Stamp now) {
  return then.ns > now.ns ? "in the future: check the clock" : AgeText(now.ns - then.ns) + " ago";
}

bool IsNever(const RobotSummary& robot) { return robot.revision == 0 || !robot.validity.calibrated_at; }

std::string AgeLimitText(const Validity& validity) {
  const std::string limit = "limit " + AgeText(validity.max_age_ns);
  const auto until = ValidUntil(validity);
  return until ? limit + ": " + DayText(*until) : limit;
}

}  // namespace rigcal::report
