// When a robot's edges become a revision.
#pragma once

#include <vector>

#include "server/base/ids.h"
#include "server/base/stamp.h"
#include "storage/store.h"

namespace rigcal::pipeline {

// A robot is revised when none of its `jobs` is waiting, or its first new edge has waited for 45 s: so edges are in a
// revision within a minute, whatever else the robot brings.
[[nodiscard]] Result<bool> IsRevisionDue(storage::Store& store, Stamp now, const RobotId& robot, std::int64_t jobs);
// Is a robot to be revised before reports of others are drawn? Its edges have waited for 10 s, it is due, not one of
// `taken` and not given up, and no report has waited a minute longer: neither waits for ever where robots push without
// a pause.
[[nodiscard]] Result<bool> IsRevisionPressing(storage::Store& store, Stamp now, const std::vector<RobotId>& taken);

}  // namespace rigcal::pipeline
