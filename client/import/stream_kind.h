// Whether a bag is a stream of sensors that run freely, or a list of stills that were taken together: by stamps alone.
#pragma once

#include <vector>

#include "client/import/captures.h"

namespace rigcal::importing {

// A stream: a camera of 4 Hz or more, and either two such cameras whose rates differ by a fifth or more, or, of the
// cameras and lidars, fewer than half of the messages of the one with the fewest match another's within `tolerance_ns`.
// Anything else is taken as it is: sensors that were triggered together, and stills.
[[nodiscard]] bool RunsFreely(const std::vector<SensorStamps>& cameras, const std::vector<SensorStamps>& others,
                              std::int64_t tolerance_ns);
// Median time between two messages; nothing of fewer than three.
[[nodiscard]] std::optional<std::int64_t> Period_ns(std::vector<std::int64_t> stamps_ns);

}  // namespace rigcal::importing
