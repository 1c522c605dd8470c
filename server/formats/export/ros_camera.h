// A camera as ROS has it in camera_info, in files and on topics: not rectified, so R is the identity and P = [K | 0].
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "server/model/sensors/camera_fit.h"

namespace rigcal::exports {

struct RosCamera {
  int width_px = 0, height_px = 0;
  std::string distortion_model;  // "plumb_bob", "rational_polynomial", "equidistant"
  std::vector<double> D;         // in OpenCV's order
  Eigen::Matrix3d K, R;          // of the picture as it is; the centre of the first pixel is 0, 0
  Eigen::Matrix<double, 3, 4> P;
};
// `camera` has intrinsics and a size; ROS has no name for sphere models (LeaveOutSpheres).
[[nodiscard]] RosCamera RosCameraOf(const CameraFit& camera);

}  // namespace rigcal::exports
