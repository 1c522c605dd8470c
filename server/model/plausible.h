// Numbers that no rig has. They come from a mistake in units or a broken tool, and would spoil every solution.
#pragma once

#include "server/base/result.h"
#include "server/math/se3.h"
#include "server/math/tangent.h"

namespace rigcal {

inline constexpr double kPositionMax_m = 1e6;    // of one sensor in another, each axis
inline constexpr double kInformationMax = 1e18;  // 1/m^2, 1/rad^2: a sigma of 1 nm, 1 nrad
inline constexpr double kFocalMax_px = 1e6;      // also of the principal point

// kInvalidInput beyond kPositionMax_m; `p_m` is finite.
[[nodiscard]] Status CheckPlausible(const Eigen::Vector3d& p_m);
// Of a pose as people or CAD give it: kInvalidInput where a position is not finite or beyond that, or q_xyzw has not
// unit length to 1e-6. `what` is about the pose: who asks says whose it is.
[[nodiscard]] Status CheckGivenPose(const Se3& T);
// kInvalidInput where an entry is beyond kInformationMax; `Omega` is finite.
[[nodiscard]] Status CheckPlausible(const Matrix6d& Omega);

}  // namespace rigcal
