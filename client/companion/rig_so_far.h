// The rig as far as it can be planned with: lenses as given or as estimated so far, poses by the boards that two
// cameras saw at once, else as drawn.
#pragma once

#include <optional>
#include <vector>

#include "client/companion/captured.h"
#include "server/calib/placement/planned_rig.h"

namespace rigcal::companion {

struct RigSoFar {
  calib::placement::PlannedRig rig;                        // cameras in the header's order
  std::vector<calib::placement::PlannedCapture> captures;  // boards that at least one of them has a pose of
  std::vector<SensorId> unplaced;                          // cameras that nothing places yet: they are not in `rig`
};
// Pure and deterministic. Where the reference sensor is no camera that can be planned with, the first that can be is
// `rig.reference`. Tolerances are the defaults: no server is asked for its policy.
[[nodiscard]] RigSoFar RigOf(const Captured& captured);

// Of one thing each capture allows several poses, the likeliest first. The one that most captures have one near to,
// within 2 cm or a hundredth of the distance, and 1 degree; of equals the nearest to `drawn`, without it the first. At
// least one capture with at least one.
[[nodiscard]] Se3 MostAgreedOn(const std::vector<std::vector<Se3>>& captures, const std::optional<Se3>& drawn);

}  // namespace rigcal::companion
