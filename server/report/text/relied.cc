#include "server/report/text/relied.h"

#include <algorithm>

#include "server/model/approval/validity.h"

namespace rigcal::report {

bool Has(const std::vector<SensorId>& sensors, const SensorId& sensor) {
  return std::find(sensors.begin(), sensors.end(), sensor) != sensors.end();
}

bool IsReliedOn(const SensorId& sensor, const Verdict& verdict, const VerdictBasis& basis) {
  if (IsUsable(verdict)) return true;
  const bool failed = verdict.level == VerdictLevel::kFail;
  const std::vector<SensorId>& named = failed ? basis.culprits : basis.doubted;
  if (!named.empty()) return !Has(named, sensor);
  return failed ? basis.empty() : !verdict.unverified.empty();
}

}  // namespace rigcal::report
