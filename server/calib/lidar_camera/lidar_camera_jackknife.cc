#include <Eigen/QR>
#include <algorithm>
#include <cmath>

#include "server/calib/camera/intrinsics.h"
#include "server/calib/core/leave_one_out.h"
#include "server/calib/lidar_camera/lidar_camera.h"
#include "server/calib/lidar_camera/lidar_camera_diagnoses.h"
#include "server/calib/lidar_camera/lidar_camera_work.h"
#include "server/math/covariance.h"

namespace rigcal::calib {
namespace {

Se3 EdgePose(const LidarCameraProblem& problem, const Se3& T_cam_lidar) {
  return problem.camera_is_a ? T_cam_lidar : T_cam_lidar.Inverse();
}

Result<Se3> PoseOf(const LidarCameraProblem& problem, const Result<LidarCameraEstimate>& solved) {
  if (!solved) return Fail(solved.error());
  return EdgePose(problem, solved->T_cam_lidar);
}

void AddBoardSize(const LidarCameraProblem& problem, const LidarCameraEstimate& estimate,
                  std::vector<GivenConstant>& constants) {
  const double shown_ratio = estimate.SuspectsBoardSize() ? std::abs(estimate.board_scale_ratio) : 0.0;
  const double ratio = std::max(shown_ratio, problem.board.square_sigma_m / problem.board.square_m);
  const auto with_size = [&problem, &estimate](double larger_ratio) {
    LidarCameraEstimate start = estimate;
    for (auto& [capture, T_cam_board] : start.camera.T_cam_board) T_cam_board.p_m *= 1 + larger_ratio;
    return PoseOf(problem, SolvedAgain(problem, start));
  };
  AddBoardSize(problem.board, ratio, with_size, constants);
}

void AddIntrinsics(const LidarCameraProblem& problem, const LidarCameraEstimate& estimate,
                   std::vector<GivenConstant>& constants) {
  for (const int i : RefinedOf(problem.camera))
    constants.push_back({IntrinsicsName(problem.camera.id), [&problem, &estimate, i](double sigmas) {
                           return PoseOf(problem,
                                         SolvedWithCamera(problem, estimate, WithGiven(estimate.camera, i, sigmas)));
                         }});
}

// The part of the model that comes from the corners by way of the intrinsics: the planes take those as known.
Result<Matrix6d> CornersPart(const LidarCameraProblem& problem, const LidarCameraEstimate& estimate) {
  Matrix6d part = Matrix6d::Zero();
  std::vector<GivenConstant> changes;
  for (const IntrinsicsVector& change : ChangesOfIntrinsics(problem, estimate))
    changes.push_back({"corners", [&problem, &estimate, change](double steps) {
                         return PoseOf(problem, SolvedWithCamera(problem, estimate,
                                                                 WithIntrinsicsMoved(estimate.camera, steps * change)));
                       }});
  RIGCAL_ASSIGN(const std::vector<Contribution> contributions, ContributionsOf(changes));
  for (const Contribution& contribution : contributions) part += contribution.covariance;
  return part;
}

// What was given, and no less than what the captures show.
double RangeBiasSigma_m(const LidarCameraProblem& problem, const LidarCameraEstimate& estimate) {
  const double shown_m = estimate.SuspectsRangeBias() ? std::abs(estimate.range_bias_m - problem.range_bias_m) : 0.0;
  return std::max(shown_m, problem.lidar.range_bias_sigma_m.value_or(0.0));
}

std::vector<GivenConstant> ConstantsOf(const LidarCameraProblem& problem, const LidarCameraEstimate& estimate) {
  std::vector<GivenConstant> constants;
  AddBoardSize(problem, estimate, constants);
  AddIntrinsics(problem, estimate, constants);
  const auto with_bias = [&problem, &estimate](double longer_m) {
    LidarCameraProblem moved = problem;
    moved.range_bias_m += longer_m;
    return PoseOf(moved, SolvedAgain(moved, estimate));
  };
  const auto with_beams = [&problem, &estimate](std::size_t group, double longer_m) {
    return PoseOf(problem, SolvedWithBeamsMoved(problem, estimate, group, longer_m));
  };
  AddRangeBias(problem.lidar.id, RangeBiasSigma_m(problem, estimate), with_bias, constants);
  AddBeams(problem.lidar, BeamsSeen(problem, estimate), EdgePose(problem, estimate.T_cam_lidar), with_beams, constants);
  return constants;
}

// Columns: the directions of the edge's pose, right tangent at its b, that the boards tell.
Directions ObservedDirections(const LidarCameraProblem& problem, const LidarCameraEstimate& estimate) {
  if (!estimate.held) return Matrix6d::Identity();
  const Vector6d untold =
      problem.camera_is_a ? estimate.untold : Vector6d(Adjoint(estimate.T_cam_lidar) * estimate.untold);
  const Eigen::HouseholderQR<Vector6d> qr(untold);
  const Matrix6d Q = qr.householderQ();
  return Q.rightCols<5>();
}

}  // namespace

Result<Uncertainty> JackknifeLidarCamera(const LidarCameraProblem& problem, const LidarCameraEstimate& estimate) {
  RIGCAL_ASSIGN(std::vector<Contribution> contributions, ContributionsOf(ConstantsOf(problem, estimate)));
  RIGCAL_ASSIGN(const Matrix6d corners, CornersPart(problem, estimate));
  const Matrix6d C_planes =
      problem.camera_is_a ? estimate.C_model : InverseCovariance(estimate.T_cam_lidar, estimate.C_model);
  const Matrix6d C_model = Symmetrized(C_planes + corners);
  std::vector<BlockVector> blocks;
  const std::vector<CaptureBlock> left_out = BlocksOf(problem, estimate);
  const std::size_t carrying = CarryingBlocks(left_out, estimate);
  if (carrying >= kLidarCapturesForJackknife) {
    const auto without = [&](std::size_t k) {
      return PoseOf(problem, SolvedWithout(problem, estimate, left_out[k].captures));
    };
    RIGCAL_ASSIGN(blocks, LeaveOneOut(IdsOf(left_out), EdgePose(problem, estimate.T_cam_lidar), without));
  }
  const auto told = ObservedDirections(problem, estimate);
  return UncertaintyAlong(told, told.transpose() * C_model * told, std::move(blocks), std::move(contributions),
                          carrying);
}

}  // namespace rigcal::calib
