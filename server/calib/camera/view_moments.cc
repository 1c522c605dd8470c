#include "server/calib/camera/view_moments.h"

#include <ceres/cost_function.h>

#include <Eigen/LU>

#include "server/calib/core/costs.h"
#include "server/calib/core/pose_block.h"

namespace rigcal::calib {
namespace {

using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

}  // namespace

std::optional<ViewMoments> MomentsAt(CameraModel model, const IntrinsicsVector& intrinsics,
                                     const std::vector<Eigen::Vector3d>& corners_board, const SeenCorners& seen,
                                     const Se3& T_cam_board) {
  const auto cost = MakeReferenceViewCost(model, corners_board, seen);
  const int count = IntrinsicsCount(model);
  RowMajor d_intrinsics(cost->num_residuals(), count), d_pose(cost->num_residuals(), kPoseSize);
  Eigen::VectorXd residuals(cost->num_residuals());
  const PoseBlock pose = BlockOf(T_cam_board);
  const double* blocks[] = {intrinsics.data(), pose.data()};
  double* jacobians[] = {d_intrinsics.data(), d_pose.data()};
  if (!cost->Evaluate(blocks, residuals.data(), jacobians)) return std::nullopt;
  Eigen::Matrix<double, Eigen::Dynamic, kIntrinsicsMax + 6> J =
      Eigen::MatrixXd::Zero(residuals.size(), kIntrinsicsMax + 6);
  J.leftCols(count) = d_intrinsics;
  J.rightCols<6>() = d_pose * PlusJacobian(T_cam_board);
  return ViewMoments{T_cam_board, J.transpose() * J, J.transpose() * residuals, residuals.squaredNorm()};
}

ViewOfIntrinsics Eliminated(const ViewMoments& view) {
  const Matrix6d inverse = Matrix6d(view.normal.bottomRightCorner<6, 6>()).inverse();
  const Eigen::Matrix<double, kIntrinsicsMax, 6> mixed = view.normal.topRightCorner<kIntrinsicsMax, 6>();
  ViewOfIntrinsics reduced;
  reduced.information =
      view.normal.topLeftCorner<kIntrinsicsMax, kIntrinsicsMax>() - mixed * inverse * mixed.transpose();
  reduced.gradient = view.gradient.head<kIntrinsicsMax>() - mixed * (inverse * view.gradient.tail<6>());
  reduced.d_board = -inverse * mixed.transpose();
  return reduced;
}

}  // namespace rigcal::calib
