// What robots say that they run. Append-only; of each robot the newest holds.
#pragma once

#include <optional>

#include "server/model/robots/robot_runs.h"
#include "storage/store.h"

namespace rigcal::storage {

// False, and a no-op, where the robot said so before: nothing is kept but changes. kNotFound for a robot that is not
// known; kInvalidInput unless `who` is one printable line of at most 64 bytes.
[[nodiscard]] Result<bool> AppendRuns(Store& store, const RunsReport& report, Stamp now);
// Nothing: it never told.
[[nodiscard]] Result<std::optional<RobotRuns>> LoadRuns(Store& store, const RobotId& robot);

}  // namespace rigcal::storage
