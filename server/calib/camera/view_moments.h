// One view near a pose of its board, as a quadratic function of intrinsics and pose.
#pragma once

#include <optional>
#include <vector>

#include "server/calib/camera/projection.h"
#include "server/calib/camera/seen_corners.h"
#include "server/math/se3.h"

namespace rigcal::calib {

// Normal matrix and gradient over [intrinsics, board pose (right tangent)], px^2.
struct ViewMoments {
  Se3 T_cam_board;
  Eigen::Matrix<double, kIntrinsicsMax + 6, kIntrinsicsMax + 6> normal;
  Eigen::Matrix<double, kIntrinsicsMax + 6, 1> gradient;
  double ssr_px2 = 0;
};
// Nothing where the board does not lie in front of the camera.
[[nodiscard]] std::optional<ViewMoments> MomentsAt(CameraModel model, const IntrinsicsVector& intrinsics,
                                                   const std::vector<Eigen::Vector3d>& corners_board,
                                                   const SeenCorners& seen, const Se3& T_cam_board);

// What the view says of the intrinsics when its pose follows them.
struct ViewOfIntrinsics {
  Eigen::Matrix<double, kIntrinsicsMax, kIntrinsicsMax> information;
  IntrinsicsVector gradient;
  Eigen::Matrix<double, 6, kIntrinsicsMax> d_board;  // T_cam_board * Exp(d_board * change of the intrinsics)
};
// Schur complement over the board's pose, whose block of the normal matrix has to be invertible.
[[nodiscard]] ViewOfIntrinsics Eliminated(const ViewMoments& view);

}  // namespace rigcal::calib
