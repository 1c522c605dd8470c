// What sensors of which one visit is in use scatter by: one visit tells nothing of it.
#pragma once

#include "server/fleet/as_found/as_found.h"

namespace rigcal::fleet {

// Those sensors get what the other robots of the rig model tell, else what is assumed (KnownPose::assumed_variance),
// in their variance for the visit in use and for the session's. What is told of a sensor already stays.
[[nodiscard]] KnownPoses WithScatter(KnownPoses in_use, const AsFoundInput& input);

}  // namespace rigcal::fleet
