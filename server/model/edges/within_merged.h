// How people see what a merged edge stands for (merged_edge.h).
#pragma once

#include <string>

#include "server/base/ids.h"

namespace rigcal {

// What a person types to list the edges in it: itself it cannot be taken out.
[[nodiscard]] std::string WithinCommand(const RobotId& robot, const EdgeId& merged);

}  // namespace rigcal
