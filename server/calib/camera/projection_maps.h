// What is different between two estimates of one camera's lens, for the comparison of two revisions.
#pragma once

#include <optional>

#include "server/model/camera_fit.h"
#include "server/model/projection_map.h"

namespace rigcal::calib {

// Of the far point with the ray v = pi^-1(b0, q) of a pixel q, with b0 the intrinsics before and b1 those now:
//   shift(q) = pi(b1, R v) - q,   R = argmin sum_i w_i |pi(b1, R v_i) - q_i|^2.
// The rotation R is the one between the two cameras that the intrinsics imply (of one and the same camera: where a
// lens points is a matter of its pose); it is found over the middles of the fields, from the identity by Gauss and
// Newton, with w = n0 n1 / (n0 + n1) of the corners n0 and n1 that the two saw there (all alike where they saw no field
// both). Source: mrcal (Kogan), "Model differencing", for points at infinity.
//
// Nothing where one of both has no intrinsics, or the pictures are of different size.
[[nodiscard]] std::optional<LensChange> ChangeOfLens(const CameraFit& before, const CameraFit& now);

}  // namespace rigcal::calib
