// The true lenses of the sphere models, which OpenCV does not have: projected step by step as the papers' figures draw
// them, derivatives by complex steps, and rays by bisection, so that nothing of it is the calibration's mathematics.
#pragma once

#include "client/sim/rig/lens.h"

namespace rigcal::sim {

// As PixelsOf, PixelsWithDerivatives and RaysOf, of eucm and double_sphere.
[[nodiscard]] std::vector<Eigen::Vector2d> SpherePixelsOf(const CameraIntrinsics& intrinsics,
                                                          const std::vector<Eigen::Vector3d>& points_cam);
[[nodiscard]] std::vector<LensPoint> SpherePixelsWithDerivatives(const CameraIntrinsics& intrinsics,
                                                                 const std::vector<Eigen::Vector3d>& points_cam);
// Beyond the border of the image the ray of the border.
[[nodiscard]] std::vector<Eigen::Vector3d> SphereRaysOf(const CameraIntrinsics& intrinsics,
                                                        const std::vector<Eigen::Vector2d>& pixels);

}  // namespace rigcal::sim
