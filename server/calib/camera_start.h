// Starting values of one camera: intrinsics from its views, and the board's pose in each.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "server/base/result.h"
#include "server/calib/projection.h"
#include "server/math/se3.h"

namespace rigcal::calib {

// All views of one camera: pictures of one size, corners in the order of `corners_board`.
struct CameraViews {
  int width_px = 0, height_px = 0;
  std::vector<Eigen::Vector3d> corners_board;
  std::vector<std::vector<Eigen::Vector2d>> corners_px;
};

// Focal lengths from vanishing points, principal point in the middle, no distortion; where the views do not tell the
// focal length (no tilt), the picture's longer side. Always usable.
[[nodiscard]] IntrinsicsVector RoughIntrinsics(const CameraViews& views);
// Zhang (2000) with two radial terms, on at most some tens of the views, evenly spread.
[[nodiscard]] Result<IntrinsicsVector> ZhangIntrinsics(const CameraViews& views);
// Poses T_cam_board that explain one view, best first: a plane seen small has two (Collins & Bartoli 2014). May be
// empty.
[[nodiscard]] std::vector<Se3> PlanarPoses(const IntrinsicsVector& intrinsics,
                                           const std::vector<Eigen::Vector3d>& corners_board,
                                           const std::vector<Eigen::Vector2d>& corners_px);

}  // namespace rigcal::calib
