// The pairs of a robot of four sensors whose history is merged.
#pragma once

#include <utility>
#include <vector>

#include "server/base/ids.h"

namespace rigcal::graph {

inline const RobotId kRobot("r1");
inline const std::vector<std::pair<const char*, const char*>> kPairs = {
    {"a", "b"}, {"b", "c"}, {"a", "c"}, {"c", "d"}, {"b", "d"}};

}  // namespace rigcal::graph
