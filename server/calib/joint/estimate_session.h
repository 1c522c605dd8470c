// The session estimate: start, refinement, covariance, and whether one rig is behind all captures.
#pragma once

#include "server/calib/joint/session_start.h"
#include "server/model/session_estimate.h"

namespace rigcal::calib::joint {

// Changes less likely than this by chance are told: of 1,000 sessions in which nothing moved, less than one is accused.
constexpr double kMovedOdds = 5e-4;
// A sensor that surely (by 3 sigmas) moved less than both is not told: no lens and no mount is known that well.
constexpr double kMovedMin_m = 0.001, kMovedMin_rad = 0.001;

// Pure and deterministic; never throws. `session` of the result is left empty.
[[nodiscard]] SessionEstimate EstimateSession(const SessionViews& views);

}  // namespace rigcal::calib::joint
