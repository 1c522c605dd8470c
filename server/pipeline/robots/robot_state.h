// READ: what whoever listens to a robot is told of it (model/robots/robot_state.h).
#pragma once

#include <optional>

#include "server/model/robots/robot_state.h"
#include "storage/store.h"

namespace rigcal::pipeline {

// As of one snapshot. Nothing of a robot without a revision.
[[nodiscard]] Result<std::optional<RobotState>> LoadRobotState(storage::Store& store, const RobotId& robot);

}  // namespace rigcal::pipeline
