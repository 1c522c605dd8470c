#include "server/calib/core/se3_manifold.h"

#include <ceres/manifold.h>

#include "server/calib/core/pose_block.h"

namespace rigcal::calib {
namespace {

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

std::unique_ptr<ceres::Manifold> MakeSe3Manifold() { return std::make_unique<Se3Manifold>(); }

}  // namespace rigcal::calib
