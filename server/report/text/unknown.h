// Why a sensor has no pose, in words.
#pragma once

#include <map>
#include <string>

#include "server/report/render.h"

namespace rigcal::report {

// For every sensor of the solution that is not known whole: one clause ("no edge names it", "the height was not
// measured; the rest is good to 0.66 mm and 0.11 deg", ...).
[[nodiscard]] std::map<SensorId, std::string> WhyUnknown(const formats::RevisionInput& revision);

}  // namespace rigcal::report
