// Which sensors a verdict vouches for: what figures count is what the drive rule says.
#pragma once

#include "server/model/diagnosis.h"
#include "server/model/verdict_basis.h"

namespace rigcal::report {

// True of all where it passes or warns, and where it is from before it was kept whom it does not rely on. A failure
// that accuses nobody by name, and an unknown verdict that names nobody, vouch for none.
[[nodiscard]] bool IsReliedOn(const SensorId& sensor, const Verdict& verdict, const VerdictBasis& basis);
[[nodiscard]] bool Has(const std::vector<SensorId>& sensors, const SensorId& sensor);

}  // namespace rigcal::report
