// The session estimate: start, refinement, covariance, and whether one rig is behind all captures.
#pragma once

#include "server/calib/joint/problem/session_start.h"
#include "server/model/sessions/session_estimate.h"

namespace rigcal::calib::joint {

// Pure and deterministic; never throws. `session` of the result is left empty.
[[nodiscard]] SessionEstimate EstimateSession(const SessionViews& views);

}  // namespace rigcal::calib::joint
