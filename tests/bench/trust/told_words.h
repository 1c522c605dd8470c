// What sentences of the service say, read as a technician reads them.
#pragma once

#include <set>
#include <string_view>
#include <vector>

#include "tests/bench/trust/told.h"

namespace rigcal {

// Ids that stand in a text as words of their own.
[[nodiscard]] std::set<SensorId> SensorsIn(std::string_view text, const std::vector<SensorId>& sensors);
// Captures that are named; their ids are numbers, and numbers that count or measure something are none of them.
[[nodiscard]] std::set<CaptureId> CapturesIn(std::string_view text, const std::vector<CaptureId>& captures);

// A verdict that sends someone to a sensor because it may have moved, or finds it in two places.
[[nodiscard]] bool SaysMoved(std::string_view text);
// One that speaks of a lens: what it bends, which model it needs.
[[nodiscard]] bool SaysLens(std::string_view text);

}  // namespace rigcal
