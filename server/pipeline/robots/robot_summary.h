// READ: what the store says of one robot at a glance, worked out now. What lists show of it was stored (summaries.h).
#pragma once

#include <optional>

#include "server/model/robots/robot_summary.h"
#include "storage/sessions/sessions.h"
#include "storage/store.h"

namespace rigcal::pipeline {

// kNotFound for a robot that the store does not know.
[[nodiscard]] Result<storage::RobotRow> LoadKnownRobot(storage::Store& store, const RobotId& robot);
// Likewise.
[[nodiscard]] Result<RobotSummary> LoadRobotSummary(storage::Store& store, const RobotId& robot, Stamp now);
// Of a robot without a revision, that has a batch of edges which is not whole: what is missing of it.
[[nodiscard]] Result<std::optional<Error>> IncompleteBatch(storage::Store& store, const RobotId& robot);

}  // namespace rigcal::pipeline
