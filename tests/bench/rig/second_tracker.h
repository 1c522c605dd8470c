// Another body of the rig, whose tracker tells its poses in a world of its own: odometry beside motion capture, say.
#pragma once

#include "client/sim/visit/experiment.h"

namespace rigcal {

inline const SensorId kMast("mast");

// With a mast that stands on the tracker `body`: not calibrated with what that is not calibrated with.
[[nodiscard]] sim::Rig WithMast(sim::Rig rig);

// Half-way its origin is elsewhere by `moved`, as after a tracker that lost its way found it again; and it drifts from
// capture to capture by `drift`, per axis.
struct OtherWorld {
  sim::Displacement moved, drift;
};
// Some metres and any yaw from the first tracker's, by the experiment's seed.
void DrawWorldOfMast(const OtherWorld& world, sim::Experiment& experiment);

}  // namespace rigcal
