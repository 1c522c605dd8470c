#include "server/math/roll_pitch_yaw.h"

#include <Eigen/Geometry>
#include <cmath>

namespace rigcal {
namespace {
constexpr double kGimbalCosMin = 1e-14;  // of the pitch: below, roll and yaw turn about one axis
}

// Whatever yaw is taken, roll and pitch are those of what is left after it: next to +-90 degrees of pitch an error of
// yaw is made good by roll.
Eigen::Vector3d RollPitchYawOf(const Eigen::Matrix3d& R) {
  const bool locked = std::hypot(R(0, 0), R(1, 0)) < kGimbalCosMin;
  const double yaw = locked ? std::atan2(-R(0, 1), R(1, 1)) : std::atan2(R(1, 0), R(0, 0));
  const double c = std::cos(yaw), s = std::sin(yaw);
  const double pitch = std::atan2(-R(2, 0), c * R(0, 0) + s * R(1, 0));
  const double roll = locked ? 0.0 : std::atan2(s * R(0, 2) - c * R(1, 2), c * R(1, 1) - s * R(0, 1));
  return {roll, pitch, yaw};
}

Eigen::Matrix3d RotationOf(const Eigen::Vector3d& roll_pitch_yaw_rad) {
  return (Eigen::AngleAxisd(roll_pitch_yaw_rad[2], Eigen::Vector3d::UnitZ()) *
          Eigen::AngleAxisd(roll_pitch_yaw_rad[1], Eigen::Vector3d::UnitY()) *
          Eigen::AngleAxisd(roll_pitch_yaw_rad[0], Eigen::Vector3d::UnitX()))
      .toRotationMatrix();
}

}  // namespace rigcal
