// Poses of bodies and frames, and what an IMU feels.
#pragma once

#include <string>
#include <vector>

#include "client/bags/messages/header.h"
#include "server/math/se3.h"

namespace rigcal::bags {

// The pose of `child` in the frame of the header: p_frame = T_frame_child p_child.
struct StampedPose {
  Header header;
  std::string child;  // of odometry and transforms; else empty
  Se3 T_frame_child;  // metres; the quaternion of unit length
};
// PoseStamped, PoseWithCovarianceStamped, TransformStamped, Odometry (its pose). kInvalidInput: values that are not
// finite, a quaternion that is not of unit length within 0.01.
[[nodiscard]] Result<StampedPose> ReadPose(const Value& message);
// All of a TFMessage, in its order; errors as of ReadPose.
[[nodiscard]] Result<std::vector<StampedPose>> ReadTransforms(const Value& message);

struct Imu {
  Header header;
  Eigen::Vector3d angular_velocity_rad_s = Eigen::Vector3d::Zero();
  Eigen::Vector3d acceleration_m_s2 = Eigen::Vector3d::Zero();
};
// kInvalidInput: values that are not finite.
[[nodiscard]] Result<Imu> ReadImu(const Value& message);

}  // namespace rigcal::bags
