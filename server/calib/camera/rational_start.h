// Starting values of a wide pinhole_rational lens: a fisheye converges from views in part, and is told again as a
// quotient.
#pragma once

#include <optional>

#include "server/calib/camera/projection.h"

namespace rigcal::calib {

// The rational lens that bends as the fisheye does up to `reach_rad` from the axis, focal lengths and principal point
// as they are. Nothing where a pinhole does not see as far, or no quotient bends so.
[[nodiscard]] std::optional<IntrinsicsVector> RationalLike(const IntrinsicsVector& fisheye, double reach_rad);

}  // namespace rigcal::calib
