// Boards as the service finds them in clouds, instead of points that the truth cuts out.
#pragma once

#include "tests/bench/rig/feature_session.h"

namespace rigcal {

// Replaces every cloud view by what a search in the whole scan gives: the scan that a cloud file would hold.
void FindPlates(FeatureSession& session);

}  // namespace rigcal
