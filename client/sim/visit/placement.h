// Where the robot stands at each capture.
#pragma once

#include "client/sim/visit/experiment.h"

namespace rigcal::sim {

// A pose of the body somewhere in the rig's range of motion.
[[nodiscard]] Se3 DrawBodyPose(const Experiment& experiment, std::uint64_t key);
// Names, times and poses of all captures.
void PlaceCaptures(Experiment& experiment, Stamp start);

}  // namespace rigcal::sim
