#include "server/calib/motion/camera_motion.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "server/calib/camera/camera_diagnoses.h"
#include "server/calib/camera/seen_corners.h"
#include "server/calib/core/selection.h"

namespace rigcal::calib {
namespace {

constexpr double kSmallestVariance_px2 = 1e-6;  // of perfect data: weights stay finite

Se3 TurnAbout(const Eigen::Vector3d& centre_m, double angle_rad) {
  Se3 turn;
  turn.q = Eigen::Quaterniond(Eigen::AngleAxisd(angle_rad, Eigen::Vector3d::UnitZ()));
  turn.p_m = centre_m - turn.q * centre_m;
  return turn;
}

// The shared parameters are the intrinsics less those of `motion.camera`. Held ones stay where they are.
void AddGiven(const CameraMotion& motion, MotionSide& side) {
  const IntrinsicsVector away = VectorOf(motion.camera.intrinsics) - motion.camera.pull.given;
  for (int i = 0; i < motion.intrinsics_count; ++i) {
    const double sigma = motion.camera.pull.sigma[i];
    if (sigma > 0) {
      side.information(i, i) += 1 / (sigma * sigma);
      side.gradient[i] += away[i] / (sigma * sigma);
    } else {
      side.information.row(i).setZero();
      side.information.col(i).setZero();
      side.information(i, i) = 1;
      side.gradient[i] = 0;
    }
  }
}

double VarianceOf(const CameraMotion& motion) { return std::max(motion.camera.variance_px2, kSmallestVariance_px2); }

}  // namespace

OrDiagnosis<CameraMotion> CameraMotionOf(const CameraProblem& problem, const CameraSolver& solver) {
  RIGCAL_ASSIGN(auto camera, EstimateCameraBy(solver, problem));
  CameraMotion motion;
  motion.camera = std::move(camera);
  motion.estimates_intrinsics = !HoldsIntrinsics(problem.camera);
  motion.turns = SymmetryOf(problem.board);
  motion.centre_board_m = CentreOf(problem.board);
  const CameraModel model = ModelOf(problem.camera);
  motion.intrinsics_count = IntrinsicsCount(model);
  const IntrinsicsVector intrinsics = VectorOf(motion.camera.intrinsics);
  const std::vector<Eigen::Vector3d> corners_board = TargetPoints(problem.board);
  for (const auto& [capture, view] : problem.views) {
    if (!motion.camera.T_cam_board.contains(capture)) continue;
    for (const Se3& T_cam_board : motion.camera.PosesOf(capture))
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
  for (int i = 0; i < motion.intrinsics_count; ++i)
    if (motion.camera.pull.Pulls() && !(motion.camera.pull.sigma[i] > 0)) pose.d_shared.col(i).setZero();
  return pose;
}

void FillShared(const CameraMotion& motion, const std::map<CaptureId, std::size_t>& chosen,
                const std::set<CaptureId>& without, double factor, MotionSide& side) {
  const int count = motion.estimates_intrinsics ? motion.intrinsics_count : 0;
  side.information = SharedMatrix::Zero(count, count);
  side.gradient = SharedVector::Zero(count);
  if (count == 0) return;
  for (const auto& [capture, views] : motion.views) {
    if (without.contains(capture)) continue;
    const auto choice = chosen.find(capture);
    const ViewOfIntrinsics view = Eliminated(views[choice == chosen.end() ? 0 : choice->second]);
    side.information += view.information.topLeftCorner(count, count) / (factor * VarianceOf(motion));
    side.gradient += view.gradient.head(count) / (factor * VarianceOf(motion));
  }
  if (motion.camera.pull.Pulls()) AddGiven(motion, side);
}

}  // namespace rigcal::calib
