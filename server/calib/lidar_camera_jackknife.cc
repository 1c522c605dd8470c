#include <algorithm>
#include <array>
#include <cmath>

#include "server/calib/leave_one_out.h"
#include "server/calib/lidar_camera.h"
#include "server/calib/lidar_camera_diagnoses.h"
#include "server/math/covariance.h"

namespace rigcal::calib {
namespace {

Se3 EdgePose(const LidarCameraProblem& problem, const Se3& T_cam_lidar) {
  return problem.camera_is_a ? T_cam_lidar : T_cam_lidar.Inverse();
}

Error Reason(const Diagnosis& diagnosis) { return {ErrorCode::kInvalidInput, diagnosis.what, diagnosis.cure}; }

// Poses of the boards from the pictures, intrinsics as `sensor` gives them or estimated from these views.
tl::expected<CameraEstimate, Diagnosis> CameraAgain(const LidarCameraProblem& problem, const Sensor& sensor,
                                                    const LidarCameraEstimate& estimate, const CaptureId* without) {
  CameraProblem camera{sensor, problem.board, {}};
  for (const LidarCameraCapture& capture : problem.captures) {
    if (!estimate.camera.T_cam_board.contains(capture.capture)) continue;
    if (without == nullptr || capture.capture != *without) camera.views.emplace_back(capture.capture, *capture.view);
  }
  return EstimateCamera(camera, &estimate.camera);
}

Result<Se3> PoseFrom(const LidarCameraProblem& problem, const LidarCameraEstimate& start) {
  const auto estimate = EstimateLidarCamera(problem, &start, nullptr);
  if (!estimate) return Fail(Reason(estimate.error()));
  return EdgePose(problem, estimate->T_cam_lidar);
}

Result<Vector6d> WithoutCapture(const LidarCameraProblem& problem, const LidarCameraEstimate& estimate,
                                const CaptureId& capture) {
  LidarCameraEstimate start = estimate;
  start.patch_idx.erase(capture);
  if (!problem.camera.intrinsics) {
    auto camera = CameraAgain(problem, problem.camera, estimate, &capture);
    if (!camera) return Fail(Reason(camera.error()));
    start.camera = std::move(*camera);
  }
  RIGCAL_ASSIGN(const Se3 without, PoseFrom(problem, start));
  return Vector6d((EdgePose(problem, estimate.T_cam_lidar).Inverse() * without).Log());
}

// Captures that carry the answer: those of both, and where intrinsics are estimated every picture.
std::vector<CaptureId> BlocksOf(const LidarCameraProblem& problem, const LidarCameraEstimate& estimate) {
  std::vector<CaptureId> blocks;
  for (const LidarCameraCapture& capture : problem.captures)
    if (estimate.patch_idx.contains(capture.capture) ||
        (!problem.camera.intrinsics && estimate.camera.T_cam_board.contains(capture.capture)))
      blocks.push_back(capture.capture);
  return blocks;
}

void AddBoardSize(const LidarCameraProblem& problem, const LidarCameraEstimate& estimate,
                  std::vector<GivenConstant>& constants) {
  const double shown_ratio = estimate.SuspectsBoardSize() ? std::abs(estimate.board_scale_ratio) : 0.0;
  const double ratio = std::max(shown_ratio, problem.board.square_sigma_m / problem.board.square_m);
  if (!(ratio > 0)) return;
  constants.push_back({"size of board " + problem.board.id.str(), [&problem, &estimate, ratio](double steps) {
                         LidarCameraEstimate start = estimate;
                         for (auto& [capture, T_cam_board] : start.camera.T_cam_board)
                           T_cam_board.p_m *= 1 + steps * ratio;
                         return PoseFrom(problem, start);
                       }});
}

void AddIntrinsics(const LidarCameraProblem& problem, const LidarCameraEstimate& estimate,
                   std::vector<GivenConstant>& constants) {
  if (!problem.camera.intrinsics || !problem.camera.intrinsics_sigma) return;
  for (std::size_t i = 0; i < problem.camera.intrinsics_sigma->size(); ++i) {
    const double sigma = (*problem.camera.intrinsics_sigma)[i];
    if (!(sigma > 0)) continue;
    constants.push_back(
        {"intrinsics of " + problem.camera.id.str(), [&problem, &estimate, i, sigma](double steps) -> Result<Se3> {
           Sensor moved = problem.camera;
           CameraIntrinsics& k = *moved.intrinsics;
           (i < 4 ? *std::array{&k.fx_px, &k.fy_px, &k.cx_px, &k.cy_px}[i] : k.distortion[i - 4]) += steps * sigma;
           auto camera = CameraAgain(problem, moved, estimate, nullptr);
           if (!camera) return Fail(Reason(camera.error()));
           LidarCameraEstimate start = estimate;
           start.camera = std::move(*camera);
           return PoseFrom(problem, start);
         }});
  }
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
  if (const double sigma_m = RangeBiasSigma_m(problem, estimate); sigma_m > 0)
    constants.push_back({"range bias of " + problem.lidar.id.str(), [&problem, &estimate, sigma_m](double steps) {
                           LidarCameraProblem moved = problem;
                           moved.range_bias_m += steps * sigma_m;
                           return PoseFrom(moved, estimate);
                         }});
  return constants;
}

}  // namespace

Result<Uncertainty> JackknifeLidarCamera(const LidarCameraProblem& problem, const LidarCameraEstimate& estimate) {
  RIGCAL_ASSIGN(std::vector<Contribution> contributions, ContributionsOf(ConstantsOf(problem, estimate)));
  const Matrix6d C_model =
      problem.camera_is_a ? estimate.C_model : InverseCovariance(estimate.T_cam_lidar, estimate.C_model);
  std::vector<BlockVector> blocks;
  if (estimate.patch_idx.size() >= kLidarCapturesForJackknife) {
    const std::vector<CaptureId> captures = BlocksOf(problem, estimate);
    std::vector<std::string> ids;
    for (const CaptureId& capture : captures) ids.push_back(capture.str());
    const auto without = [&](std::size_t k) { return WithoutCapture(problem, estimate, captures[k]); };
    RIGCAL_ASSIGN(blocks, LeaveOneOut(ids, without));
  }
  return UncertaintyOf(C_model, std::move(blocks), std::move(contributions), estimate.patch_idx.size());
}

}  // namespace rigcal::calib
