// Where cameras alone tell poses, how far apart they are is as right as the size of their boards was stated: nothing
// else of the robot has a metre in it.
#pragma once

#include <string>
#include <vector>

#include "server/fleet/assess.h"

namespace rigcal::fleet {

// Half a sentence, without a stop; empty where lidars or trackers measured too, where boards have a serial number
// (their sizes are those of the registry, remarks.h) or a stated sigma (then it is in the poses' own), and where the
// boards of no session are known.
[[nodiscard]] std::string ScaleTakenAsExact(const std::vector<Edge>& edges, const SessionHeaders& headers);

}  // namespace rigcal::fleet
