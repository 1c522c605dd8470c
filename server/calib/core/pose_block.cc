#include "server/calib/core/pose_block.h"

#include <ceres/manifold.h>

namespace rigcal::calib {
namespace {

// d (q * [phi, 0]) / d phi: its columns are orthonormal for unit q.
Eigen::Matrix<double, 4, 3> LeftProduct(const Eigen::Quaterniond& q) {
  Eigen::Matrix<double, 4, 3> product;
  product.topRows<3>() = q.w() * Eigen::Matrix3d::Identity() + Hat(q.vec());
  product.bottomRows<1>() = -q.vec().transpose();
  return product;
}

template <int kRows, int kCols>
using RowMajorMap = Eigen::Map<Eigen::Matrix<double, kRows, kCols, Eigen::RowMajor>>;

class Se3Manifold final : public ceres::Manifold {
 public:
  int AmbientSize() const override { return kPoseSize; }
  int TangentSize() const override { return 6; }

  bool Plus(const double* x, const double* delta, double* x_plus_delta) const override {
    Se3 moved = PoseOf(x) * Se3::Exp(Eigen::Map<const Vector6d>(delta));
    // Not Normalized(): a jump of sign between iterations would look like a long step.
    moved.q.normalize();
    Eigen::Map<PoseBlock>(x_plus_delta, kPoseSize) = BlockOf(moved);
    return true;
  }
  bool PlusJacobian(const double* x, double* jacobian) const override {
    RowMajorMap<kPoseSize, 6>(jacobian, kPoseSize, 6) = calib::PlusJacobian(PoseOf(x));
    return true;
  }
  bool Minus(const double* y, const double* x, double* y_minus_x) const override {
    Eigen::Map<Vector6d>(y_minus_x, 6) = (PoseOf(x).Inverse() * PoseOf(y)).Log();
    return true;
  }
  bool MinusJacobian(const double* x, double* jacobian) const override {
    RowMajorMap<6, kPoseSize>(jacobian, 6, kPoseSize) = calib::MinusJacobian(PoseOf(x));
    return true;
  }
};

}  // namespace

PoseBlock BlockOf(const Se3& T) {
  PoseBlock block;
  block << T.p_m, T.q.coeffs();
  return block;
}

Se3 PoseOf(const double* block) {
  const Eigen::Map<const PoseBlock> values(block);
  Se3 T;
  T.p_m = values.head<3>();
  T.q.coeffs() = values.tail<4>();
  return T;
}

// R(q) v = v + 2 w (u x v) + 2 u x (u x v) with q = (u, w).
QuaternionJacobian RotatedByQuaternion(const Eigen::Quaterniond& q, const Eigen::Vector3d& v) {
  const Eigen::Vector3d u = q.vec();
  QuaternionJacobian jacobian;
  jacobian.leftCols<3>() =
      -2 * q.w() * Hat(v) + 2 * (u.dot(v) * Eigen::Matrix3d::Identity() + u * v.transpose() - 2 * v * u.transpose());
  jacobian.rightCols<1>() = 2 * u.cross(v);
  return jacobian;
}

QuaternionJacobian UnrotatedByQuaternion(const Eigen::Quaterniond& q, const Eigen::Vector3d& v) {
  QuaternionJacobian jacobian = RotatedByQuaternion(q.conjugate(), v);
  jacobian.leftCols<3>() *= -1;
  return jacobian;
}

Eigen::Matrix<double, kPoseSize, 6> PlusJacobian(const Se3& T) {
  Eigen::Matrix<double, kPoseSize, 6> jacobian = Eigen::Matrix<double, kPoseSize, 6>::Zero();
  jacobian.block<3, 3>(0, tangent::kTranslation) = T.R();
  jacobian.block<4, 3>(3, tangent::kRotation) = 0.5 * LeftProduct(T.q);
  return jacobian;
}

Eigen::Matrix<double, 6, kPoseSize> MinusJacobian(const Se3& T) {
  Eigen::Matrix<double, 6, kPoseSize> jacobian = Eigen::Matrix<double, 6, kPoseSize>::Zero();
  jacobian.block<3, 3>(tangent::kTranslation, 0) = T.R().transpose();
  jacobian.block<3, 4>(tangent::kRotation, 3) = 2 * LeftProduct(T.q).transpose();
  return jacobian;
}

std::unique_ptr<ceres::Manifold> MakeSe3Manifold() { return std::make_unique<Se3Manifold>(); }

}  // namespace rigcal::calib
