// READ: the verbs that tell names, for command lines that are being typed and for pushes in the name of a new robot.
#pragma once

#include <vector>

#include "server/pipeline/answers/answer.h"

namespace rigcal::pipeline {

// robot_names, sensor_names: up to kPageRowsMax names at once. known_robot: whether a robot is known, and if not, of
// which known ones its name is a slip. known_files: whether another robot's session holds these files, which session,
// and how many.
[[nodiscard]] std::vector<VerbAnswer> NameVerbs();

}  // namespace rigcal::pipeline
