// Fixed-axis angles as URDF, ROS and Autoware write rotations: R = Rz(yaw) Ry(pitch) Rx(roll), radians.
#pragma once

#include <Eigen/Core>

namespace rigcal {

// [roll, pitch, yaw] with pitch in [-pi/2, pi/2]; roll is 0 where pitch is +-90 degrees. Put together again they give R
// to rounding, also next to that. `R` is a rotation (not checked).
[[nodiscard]] Eigen::Vector3d RollPitchYawOf(const Eigen::Matrix3d& R);
[[nodiscard]] Eigen::Matrix3d RotationOf(const Eigen::Vector3d& roll_pitch_yaw_rad);

}  // namespace rigcal
