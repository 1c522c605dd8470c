// Where a camera sees a point, and along which ray it sees a pixel: the true lens, through OpenCV's own projection, so
// that a simulation does not share its mathematics with the calibration that it tests. OpenCV has no sphere models:
// sphere_lens.h does those.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "server/model/sensors/camera.h"

namespace rigcal::sim {

struct LensPoint {
  Eigen::Vector2d uv_px = Eigen::Vector2d::Zero();
  Eigen::Matrix<double, 2, 3> d_point = Eigen::Matrix<double, 2, 3>::Zero();
  Eigen::Matrix<double, 2, Eigen::Dynamic> d_intrinsics;  // fx fy cx cy and the distortion
};

// Points must lie before the camera.
[[nodiscard]] std::vector<Eigen::Vector2d> PixelsOf(const CameraIntrinsics& intrinsics,
                                                    const std::vector<Eigen::Vector3d>& points_cam);
[[nodiscard]] std::vector<LensPoint> PixelsWithDerivatives(const CameraIntrinsics& intrinsics,
                                                           const std::vector<Eigen::Vector3d>& points_cam);
// Directions (of any length, z positive but for a wide lens's border) through the pixels.
[[nodiscard]] std::vector<Eigen::Vector3d> RaysOf(const CameraIntrinsics& intrinsics,
                                                  const std::vector<Eigen::Vector2d>& pixels);
// The same lens on a picture of `scale` times the size.
[[nodiscard]] CameraIntrinsics Scaled(const CameraIntrinsics& intrinsics, double scale);

}  // namespace rigcal::sim
