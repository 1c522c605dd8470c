// Why a sensor has no pose, in words.
#pragma once

#include <map>
#include <string>

#include "server/report/render.h"

namespace rigcal::report {

// For every sensor of the solution that is not known: one clause ("no edge names it", ...).
[[nodiscard]] std::map<SensorId, std::string> WhyUnknown(const formats::RevisionInput& revision);

}  // namespace rigcal::report
