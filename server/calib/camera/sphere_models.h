// The two models that divide by distances to spheres: eucm (Khomutenko, Garcia & Martinet 2016) and double_sphere
// (Usenko, Demmel & Cremers 2018), as server/model/sensors/camera.h writes them. For projection.cc.
#pragma once

#include "server/calib/camera/projection.h"

namespace rigcal::calib {

// As Project.
[[nodiscard]] Projection ProjectSphere(CameraModel model, const IntrinsicsVector& intrinsics,
                                       const Eigen::Vector3d& p_cam, bool with_derivatives);
// In closed form the ray, of any length, that an image point in focal lengths from the principal point comes from; not
// finite where there is none.
[[nodiscard]] Eigen::Vector3d SphereRay(CameraModel model, const IntrinsicsVector& intrinsics,
                                        const Eigen::Vector2d& xy);

}  // namespace rigcal::calib
