// What moved between two solved states, in one sentence.
#pragma once

#include <string>

#include "server/report/text/changes.h"
#include "server/report/text/edge_moves.h"

namespace rigcal::report {

struct MovedText {
  std::string sentence;
  bool moved = false;  // something is off by kOff_sigmas or more
};
// What the measurements say by themselves, where the solution is a mean of old and new ones; "" if none is off.
[[nodiscard]] std::string WhatMeasured(const std::vector<EdgeMove>& moves);
// What says nothing of now, as no pair of it was measured anew: "rear was not measured anew: whether it moved is not
// known."; "" where each sensor that has not moved was, or is new.
[[nodiscard]] std::string WhatWasNotMeasured(const Changes& changes, const std::vector<EdgeMove>& edges);
[[nodiscard]] MovedText WhatMoved(const Changes& changes, const SensorId& reference);

}  // namespace rigcal::report
