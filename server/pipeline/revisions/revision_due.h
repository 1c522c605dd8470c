// When a robot's edges become a revision.
#pragma once

#include "server/base/stamp.h"
#include "storage/store.h"

namespace rigcal::pipeline {

// A robot is revised when none of its `jobs` is waiting, or its first new edge has waited for 45 s: so edges are in a
// revision within a minute, whatever else the robot brings.
[[nodiscard]] Result<bool> IsRevisionDue(storage::Store& store, Stamp now, const RobotId& robot, std::int64_t jobs);
// Has the robot that waits longest for its revision waited so long, 10 s, that reports of others have to wait?
[[nodiscard]] Result<bool> IsRevisionPressing(storage::Store& store, Stamp now);

}  // namespace rigcal::pipeline
