// Poses as people write them: roll, pitch, yaw of a frame with x ahead, y left, z up (R = Rz(yaw) Ry(pitch) Rx(roll)).
#pragma once

#include "server/math/se3.h"

namespace rigcal::sim {

// The pose of such a frame at p_m.
[[nodiscard]] inline Se3 Turned(const Eigen::Vector3d& p_m, const Eigen::Vector3d& rpy_rad) {
  using Eigen::AngleAxisd, Eigen::Vector3d;
  return Se3{p_m, AngleAxisd(rpy_rad.z(), Vector3d::UnitZ()) * AngleAxisd(rpy_rad.y(), Vector3d::UnitY()) *
                      AngleAxisd(rpy_rad.x(), Vector3d::UnitX())}
      .Normalized();
}

// A frame with z ahead, x right, y down (a camera, or a board as it is looked at), its view turned by rpy.
[[nodiscard]] inline Se3 Looking(const Eigen::Vector3d& p_m, const Eigen::Vector3d& rpy_rad) {
  Eigen::Matrix3d R_ahead_view;
  R_ahead_view << 0, 0, 1, -1, 0, 0, 0, -1, 0;
  return (Turned(p_m, rpy_rad) * Se3{Eigen::Vector3d::Zero(), Eigen::Quaterniond(R_ahead_view)}).Normalized();
}

}  // namespace rigcal::sim
