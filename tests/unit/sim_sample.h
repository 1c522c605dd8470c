// A small virtual rig for tests: two cameras, a lidar, a tracker and two boards in a room.
#pragma once

#include "client/sim/experiment.h"
#include "client/sim/rig_yaml.h"

namespace rigcal::sim {

[[nodiscard]] std::string SmallRigYaml();
[[nodiscard]] Rig SmallRig();
[[nodiscard]] Rig MarsMapper();
// Prepared, or the test fails.
[[nodiscard]] Experiment Prepared(const Rig& rig, const Options& options = {});

}  // namespace rigcal::sim
