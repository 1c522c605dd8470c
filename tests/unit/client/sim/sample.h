// A small virtual rig for tests: two cameras, a lidar, a tracker and two boards in a room.
#pragma once

#include "client/sim/rig/rig_yaml.h"
#include "client/sim/visit/experiment.h"

namespace rigcal::sim {

[[nodiscard]] std::string SmallRigYaml();
[[nodiscard]] Rig SmallRig();
[[nodiscard]] Rig MarsMapper();
// Prepared, or the test fails.
[[nodiscard]] Experiment Prepared(const Rig& rig, const Options& options = {});

}  // namespace rigcal::sim
