// How far an estimated pose step is from every step that is too small to matter.
#pragma once

#include "server/math/se3.h"

namespace rigcal {

// The least (step - y)^T W (step - y) over all y with |translation of y| <= radius_m and |rotation of y| <= radius_rad:
// the likelihood ratio of "the step is no larger than that"; 0 within. Of one pose step in metres and radians with its
// information W; along directions of which W knows nothing, which may mix metres and radians, nothing is counted.
// Convex, solved by its dual: y = (W + diag(mu, nu))^-1 W step with both multipliers found by bisection.
[[nodiscard]] double SquaredDistanceFromBalls(const Vector6d& step, const Matrix6d& W, double radius_m,
                                              double radius_rad);

}  // namespace rigcal
