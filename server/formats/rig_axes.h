// The axes of a camera's body as ROS and Autoware have them, which writers and readers of rig files share.
#pragma once

#include <string_view>

#include "server/math/se3.h"

namespace rigcal {

inline constexpr std::string_view kCameraLinkSuffix = "/camera_link";  // Autoware's frame of the body of a camera

// T_link_optical: the pose of the optical frame (x right, y down, z forward) in the camera's body (x forward, y left, z
// up).
[[nodiscard]] inline Se3 LinkOfOptical() {
  Se3 T_link_optical;
  T_link_optical.q = Eigen::Quaterniond(0.5, -0.5, 0.5, -0.5);
  return T_link_optical;
}

}  // namespace rigcal
