// Which sensors hang together.
#pragma once

#include <set>
#include <vector>

#include "server/base/ids.h"

namespace rigcal {

// Groups that share a sensor are one, directly or by others; sorted. An empty group is none.
[[nodiscard]] std::vector<std::set<SensorId>> Connected(const std::vector<std::set<SensorId>>& groups);

}  // namespace rigcal
