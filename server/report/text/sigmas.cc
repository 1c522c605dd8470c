#include "server/report/text/sigmas.h"

#include <algorithm>

#include "server/report/text/text.h"

namespace rigcal::report {

std::optional<PoseLimit> ToleranceOf(const formats::RevisionInput& revision, const SensorId& sensor) {
  if (!revision.policy) return std::nullopt;
  return LimitsOf(revision.policy->policy, sensor).tolerance;
}

const char* SigmasClass(double in_sigmas) {
  if (in_sigmas < 1.0) return "fit0";
  if (in_sigmas < 2.0) return "fit1";
  return in_sigmas < kOff_sigmas ? "fit2" : "fit3";
}

std::string SigmasText(double in_sigmas) {
  constexpr double kMostBelow_sigmas = 2.9;
  return Fixed(in_sigmas < kOff_sigmas ? std::min(in_sigmas, kMostBelow_sigmas) : in_sigmas, 1);
}

}  // namespace rigcal::report
