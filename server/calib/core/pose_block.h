// A pose as an optimiser's block of seven numbers [p, q_xyzw], its derivatives, and SE(3) for Ceres on it.
#pragma once

#include <Eigen/Core>
#include <memory>

#include "server/math/se3.h"

namespace ceres {
class Manifold;
}

namespace rigcal::calib {

constexpr int kPoseSize = 7;
using PoseBlock = Eigen::Matrix<double, kPoseSize, 1>;
using QuaternionJacobian = Eigen::Matrix<double, 3, 4>;

// [p, q_xyzw], q as it stands: neither is made a unit nor given another sign.
[[nodiscard]] PoseBlock BlockOf(const Se3& T);
[[nodiscard]] Se3 PoseOf(const double* block);

// d (R(q) v) / d q_xyzw and d (R(q)^T v) / d q_xyzw, of the polynomial in q that equals the rotation for unit q.
[[nodiscard]] QuaternionJacobian RotatedByQuaternion(const Eigen::Quaterniond& q, const Eigen::Vector3d& v);
[[nodiscard]] QuaternionJacobian UnrotatedByQuaternion(const Eigen::Quaterniond& q, const Eigen::Vector3d& v);

// d (T Exp(xi)) / d xi at xi = 0, and the derivative of xi = Log(T^-1 S) by the block of S at S = T.
[[nodiscard]] Eigen::Matrix<double, kPoseSize, 6> PlusJacobian(const Se3& T);
[[nodiscard]] Eigen::Matrix<double, 6, kPoseSize> MinusJacobian(const Se3& T);

// Tangent [translation, rotation], Plus(T, xi) = T * Exp(xi).
[[nodiscard]] std::unique_ptr<ceres::Manifold> MakeSe3Manifold();

}  // namespace rigcal::calib
