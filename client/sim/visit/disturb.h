// Draws what goes wrong on a visit.
#pragma once

#include "client/sim/rig/random.h"
#include "client/sim/visit/experiment.h"

namespace rigcal::sim {

// [translation, rotation] with this sigma per axis; or of just this size, in directions that are drawn.
[[nodiscard]] Vector6d ScatterOf(const Displacement& sigma, Random& random);
[[nodiscard]] Vector6d AnyWay(const Displacement& by, Random& random);
// Sizes in range, names of things that exist.
[[nodiscard]] Status CheckDisturbances(const Rig& rig, const Options& options);
// What holds for the whole visit: lenses, boards, lidars, and where each sensor sits.
void DisturbRig(const Options& options, Rig& rig);
// What happens at a capture; the captures are placed. A picture is drawn among those that show their board whole.
[[nodiscard]] Status DisturbCaptures(Experiment& experiment);

}  // namespace rigcal::sim
