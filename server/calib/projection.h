// Pinhole with radial-tangential distortion: the one projection of this module, with its derivatives.
#pragma once

#include <Eigen/Core>

#include "server/model/session.h"

namespace rigcal::calib {

constexpr int kIntrinsicsCount = 9;
using IntrinsicsVector = Eigen::Matrix<double, kIntrinsicsCount, 1>;  // fx fy cx cy k1 k2 p1 p2 k3
using PointJacobian = Eigen::Matrix<double, 2, 3>;
using IntrinsicsJacobian = Eigen::Matrix<double, 2, kIntrinsicsCount>;

[[nodiscard]] IntrinsicsVector VectorOf(const PinholeRadtan& intrinsics);
[[nodiscard]] PinholeRadtan IntrinsicsOf(const IntrinsicsVector& vector);

struct Projection {
  bool in_front = false;  // false: the point is not in front of the camera, nothing else is set
  Eigen::Vector2d uv_px = Eigen::Vector2d::Zero();
  PointJacobian d_point = PointJacobian::Zero();
  IntrinsicsJacobian d_intrinsics = IntrinsicsJacobian::Zero();
};
[[nodiscard]] Projection Project(const IntrinsicsVector& intrinsics, const Eigen::Vector3d& p_cam);

}  // namespace rigcal::calib
