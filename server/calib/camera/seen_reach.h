// How far from a camera's axis the corners of its views are.
#pragma once

#include "server/calib/camera/camera_start.h"

namespace rigcal::calib {

// Of the outermost corner, as the distortion's series takes it: the radius at depth 1 (pinhole) or the angle in radians
// (fisheye). Corners that the lens cannot see do not count.
[[nodiscard]] double SeenReach(CameraModel model, const IntrinsicsVector& intrinsics, const CameraViews& views);

}  // namespace rigcal::calib
