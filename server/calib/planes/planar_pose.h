// The poses of a flat target that one view allows.
#pragma once

#include <vector>

#include "server/calib/camera/projection.h"
#include "server/calib/camera/seen_corners.h"
#include "server/math/se3.h"

namespace rigcal::calib {

// Poses T_cam_board that explain one view, best first: a plane seen small has two (Collins & Bartoli 2014). A start,
// not refined. Looks along the middle ray of the view, so the target may be anywhere a fisheye sees; corners farther
// than 80 degrees from that ray are left away. May be empty.
[[nodiscard]] std::vector<Se3> PlanarPoses(CameraModel model, const IntrinsicsVector& intrinsics,
                                           const std::vector<Eigen::Vector3d>& corners_board, const SeenCorners& seen);

}  // namespace rigcal::calib
