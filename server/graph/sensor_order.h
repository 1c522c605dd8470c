// The order of sensors people expect: numeric names first, as numbers; then the others, letter by letter.
#pragma once

#include "server/base/ids.h"

namespace rigcal::graph {

[[nodiscard]] bool SensorBefore(const SensorId& a, const SensorId& b);

}  // namespace rigcal::graph
