#include "server/calib/camera/view_moments.h"

#include <ceres/cost_function.h>

#include <Eigen/LU>

#include "server/calib/camera/given_intrinsics.h"
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

namespace {

// Scaled to a unit diagonal: focal lengths and distortion differ by many orders of magnitude. Not finite where a
// direction is open.
Eigen::MatrixXd SolveScaled(const Eigen::MatrixXd& normal, const Eigen::MatrixXd& right) {
  const Eigen::VectorXd scale = normal.diagonal().cwiseSqrt().cwiseInverse();
  const Eigen::MatrixXd scaled = scale.asDiagonal() * normal * scale.asDiagonal();
  return scale.asDiagonal() * scaled.fullPivLu().solve(scale.asDiagonal() * right);
}

Eigen::MatrixXd Inverse(const Eigen::MatrixXd& normal) {
  return SolveScaled(normal, Eigen::MatrixXd::Identity(normal.rows(), normal.cols()));
}

Eigen::MatrixXd IfKnown(const Eigen::MatrixXd& covariance) {
  if (!covariance.allFinite() || !(covariance.diagonal().minCoeff() >= 0)) return {};
  return 0.5 * (covariance + covariance.transpose());
}

// What is left for the noise when poses, and so many intrinsics, are taken up.
double Freedom(const GatheredViews& gathered, Eigen::Index intrinsics) {
  return static_cast<double>(gathered.numbers) - 6.0 * static_cast<double>(gathered.views.size()) -
         static_cast<double>(intrinsics);
}

}  // namespace

GatheredViews::GatheredViews(CameraModel model) {
  const int count = IntrinsicsCount(model);
  normal = Eigen::MatrixXd::Zero(count, count);
  gradient = Eigen::VectorXd::Zero(count);
  motion_mixed = Eigen::MatrixXd::Zero(6, count);
}

void GatheredViews::Add(const ViewMoments& moments, std::size_t corners) {
  const Eigen::Index count = normal.rows();
  const ViewOfIntrinsics says = Eliminated(moments);
  views.push_back({says.information.topLeftCorner(count, count), says.gradient.head(count)});
  normal += views.back().normal;
  gradient += views.back().gradient;
  ssr_px2 += moments.ssr_px2;
  numbers += 2 * corners;
  const Matrix6d by_motion = Adjoint(moments.T_cam_board.Inverse());
  motion_normal += by_motion.transpose() * moments.normal.bottomRightCorner<6, 6>() * by_motion;
  motion_mixed += by_motion.transpose() * moments.normal.bottomLeftCorner(6, kIntrinsicsMax).leftCols(count);
}

Eigen::MatrixXd CovarianceByJackknife(const GatheredViews& gathered) {
  const auto m = static_cast<double>(gathered.views.size());
  Eigen::MatrixXd moved(gathered.normal.rows(), static_cast<Eigen::Index>(gathered.views.size()));
  for (std::size_t i = 0; i < gathered.views.size(); ++i)
    moved.col(static_cast<Eigen::Index>(i)) =
        -SolveScaled(gathered.normal - gathered.views[i].normal, gathered.gradient - gathered.views[i].gradient);
  const Eigen::VectorXd mean = moved.rowwise().mean();
  moved.colwise() -= mean;
  return IfKnown((m - 1) / m * moved * moved.transpose());
}

Eigen::MatrixXd CovarianceByModel(const GatheredViews& gathered) {
  const double dof = Freedom(gathered, gathered.normal.rows());
  if (!(dof > 0)) return {};
  return IfKnown(gathered.ssr_px2 / dof * Inverse(gathered.normal));
}

Eigen::MatrixXd CovarianceWithGiven(const Sensor& camera, const GatheredViews& gathered) {
  const auto count = static_cast<Eigen::Index>(camera.intrinsics_sigma->size());
  const Eigen::VectorXd given = Eigen::Map<const Eigen::VectorXd>(camera.intrinsics_sigma->data(), count);
  const double dof = Freedom(gathered, 0);
  if (!(dof > 0) || !(gathered.ssr_px2 > 0)) return given.cwiseAbs2().asDiagonal();
  Eigen::MatrixXd information = gathered.normal * (dof / gathered.ssr_px2);
  for (const int i : HeldOf(camera)) {
    information.row(i).setZero();
    information.col(i).setZero();
    information(i, i) = 1;
  }
  for (const int i : RefinedOf(camera)) information(i, i) += 1 / (given[i] * given[i]);
  Eigen::MatrixXd covariance = Inverse(information);
  for (const int i : HeldOf(camera)) covariance(i, i) = 0;
  return IfKnown(covariance);
}

Eigen::MatrixXd ImpliedMotion(const GatheredViews& gathered) {
  const Eigen::MatrixXd motion = -SolveScaled(gathered.motion_normal, gathered.motion_mixed);
  return motion.allFinite() ? motion : Eigen::MatrixXd();
}

}  // namespace rigcal::calib
