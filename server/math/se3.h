// SE(3): rigid transforms, full Exp and Log, adjoint, Jacobians. Conventions: server/math/README.md.
//
// T_a_b is the pose of frame b in frame a: p_a = T_a_b * p_b. Tangent xi = [x y z rx ry rz] (m, rad), applied on the
// RIGHT: T * Exp(xi). Exp and Log are those of SE(3) (translation V(phi) rho), not of SO(3) x R^3.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "server/math/tangent.h"

namespace rigcal {

struct Se3 {
  Eigen::Vector3d p_m = Eigen::Vector3d::Zero();
  Eigen::Quaterniond q = Eigen::Quaterniond::Identity();  // unit; canonical sign (w >= 0) after Normalized()

  friend bool operator==(const Se3&, const Se3&) = default;
  // xi = [rho, phi], m and rad; phi of any length.
  [[nodiscard]] static Se3 Exp(const Vector6d& xi);
  // `matrix` is homogeneous, its rotation orthonormal with det +1 (not checked); the last row is not read.
  [[nodiscard]] static Se3 FromMatrix(const Eigen::Matrix4d& matrix);
  [[nodiscard]] Vector6d Log() const;                                       // rotation part in [0, pi]
  [[nodiscard]] Se3 Inverse() const;                                        // T_b_a of T_a_b
  [[nodiscard]] Se3 Normalized() const;                                     // unit quaternion with w >= 0
  [[nodiscard]] Eigen::Matrix4d Matrix() const;                             // 4x4, homogeneous
  [[nodiscard]] Eigen::Matrix3d R() const { return q.toRotationMatrix(); }  // 3x3; takes q as unit
};

// T_a_c = T_a_b T_b_c, and the point p_a = T_a_b p_b in metres. The quaternions are taken as unit.
[[nodiscard]] Se3 operator*(const Se3& T_a_b, const Se3& T_b_c);
[[nodiscard]] Eigen::Vector3d operator*(const Se3& T_a_b, const Eigen::Vector3d& p_b);

// Whether T^-1 S moves by less than `shift_m` and turns by less than `turn_rad`, both parts of its logarithm.
[[nodiscard]] bool AreNear(const Se3& T, const Se3& S, double shift_m, double turn_rad);
// The rotation with the largest trace of R^T M; of M = sum u v^T the one that makes sum |u - R v|^2 least.
[[nodiscard]] Eigen::Matrix3d NearestRotation(const Eigen::Matrix3d& M);

// Hat(v) w = v x w.
[[nodiscard]] Eigen::Matrix3d Hat(const Eigen::Vector3d& v);
// Ad(T) = [R, [p]x R; 0, R]: T Exp(xi) T^-1 = Exp(Ad(T) xi).
[[nodiscard]] Matrix6d Adjoint(const Se3& T);
// Right Jacobian of SE(3) and its inverse: Exp(xi + d) ~ Exp(xi) Exp(Jr(xi) d); Log(Exp(xi) Exp(d)) ~ xi + Jr^-1(xi) d.
// Closed form (Barfoot & Furgale 2014, eq. 100-103, mirrored for the right side). Singular at |rotation| = 2 pi.
[[nodiscard]] Matrix6d RightJacobian(const Vector6d& xi);
[[nodiscard]] Matrix6d RightJacobianInverse(const Vector6d& xi);

}  // namespace rigcal
