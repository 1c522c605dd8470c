#include "server/calib/camera_motion.h"

#include <ceres/cost_function.h>

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "server/calib/camera_diagnoses.h"
#include "server/calib/costs/reference_view.h"
#include "server/calib/pose_block.h"
#include "server/calib/seen_corners.h"
#include "server/calib/selection.h"

namespace rigcal::calib {
namespace {

constexpr double kSmallestVariance_px2 = 1e-6;  // of perfect data: weights stay finite

using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

// Nothing where the board does not lie in front of the camera.
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

Se3 TurnAbout(const Eigen::Vector3d& centre_m, double angle_rad) {
  Se3 turn;
  turn.q = Eigen::Quaterniond(Eigen::AngleAxisd(angle_rad, Eigen::Vector3d::UnitZ()));
  turn.p_m = centre_m - turn.q * centre_m;
  return turn;
}

double VarianceOf(const CameraMotion& motion) { return std::max(motion.camera.variance_px2, kSmallestVariance_px2); }

}  // namespace

tl::expected<CameraMotion, Diagnosis> CameraMotionOf(const CameraProblem& problem) {
  auto camera = EstimateCamera(problem);
  if (!camera) return tl::unexpected(camera.error());
  CameraMotion motion{std::move(*camera),        !problem.camera.intrinsics, 0, {},
                      SymmetryOf(problem.board), CentreOf(problem.board)};
  const CameraModel model = ModelOf(problem.camera);
  motion.intrinsics_count = IntrinsicsCount(model);
  const IntrinsicsVector intrinsics = VectorOf(motion.camera.intrinsics);
  const std::vector<Eigen::Vector3d> corners_board = TargetPoints(problem.board);
  for (const auto& [capture, view] : problem.views) {
    const auto found = motion.camera.T_cam_board.find(capture);
    if (found == motion.camera.T_cam_board.end()) continue;
    std::vector<Se3> poses = {found->second};
    if (const auto other = motion.camera.alternatives.find(capture); other != motion.camera.alternatives.end())
      poses.insert(poses.end(), other->second.begin(), other->second.end());
    for (const Se3& T_cam_board : poses)
      if (auto moments = MomentsAt(model, intrinsics, corners_board, SeenIn(view, problem.board), T_cam_board))
        motion.views[capture].push_back(std::move(*moments));
  }
  return motion;
}

// Perturbing T_cam_board on the right by d moves its inverse on the right by -Ad(T_cam_board) d.
SidePose PoseOf(const CameraMotion& motion, const ViewMoments& view, int turn) {
  const Se3 T_turn = TurnAbout(motion.centre_board_m, 2 * M_PI * turn / motion.turns);
  const Matrix6d inverse = Matrix6d(view.normal.bottomRightCorner<6, 6>()).inverse();
  const Matrix6d M = -Adjoint(view.T_cam_board);
  SidePose pose;
  pose.T_world_sensor = ((view.T_cam_board * T_turn).Inverse()).Normalized();
  const Matrix6d covariance = VarianceOf(motion) * M * inverse * M.transpose();
  pose.covariance = Symmetrized(covariance);
  pose.d_shared = -M * inverse * view.normal.bottomLeftCorner<6, kIntrinsicsMax>().leftCols(motion.intrinsics_count);
  return pose;
}

void FillShared(const CameraMotion& motion, const std::map<CaptureId, std::size_t>& chosen, const CaptureId* without,
                MotionSide& side) {
  const int count = motion.estimates_intrinsics ? motion.intrinsics_count : 0;
  side.information = SharedMatrix::Zero(count, count);
  side.gradient = SharedVector::Zero(count);
  if (count == 0) return;
  for (const auto& [capture, views] : motion.views) {
    if (without != nullptr && capture == *without) continue;
    const auto choice = chosen.find(capture);
    const ViewMoments& view = views[choice == chosen.end() ? 0 : choice->second];
    const Matrix6d inverse = Matrix6d(view.normal.bottomRightCorner<6, 6>()).inverse();
    const Eigen::Matrix<double, kIntrinsicsMax, 6> mixed = view.normal.topRightCorner<kIntrinsicsMax, 6>();
    const Eigen::Matrix<double, kIntrinsicsMax, kIntrinsicsMax> reduced =
        view.normal.topLeftCorner<kIntrinsicsMax, kIntrinsicsMax>() - mixed * inverse * mixed.transpose();
    const Eigen::Matrix<double, kIntrinsicsMax, 1> gradient =
        view.gradient.head<kIntrinsicsMax>() - mixed * (inverse * view.gradient.tail<6>());
    side.information += reduced.topLeftCorner(count, count) / VarianceOf(motion);
    side.gradient += gradient.head(count) / VarianceOf(motion);
  }
}

}  // namespace rigcal::calib
