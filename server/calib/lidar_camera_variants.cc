#include "server/calib/lidar_camera_variants.h"

#include <array>

namespace rigcal::calib {
namespace {

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

}  // namespace

std::vector<CaptureId> BlocksOf(const LidarCameraProblem& problem, const LidarCameraEstimate& estimate) {
  std::vector<CaptureId> blocks;
  for (const LidarCameraCapture& capture : problem.captures)
    if (estimate.patch_idx.contains(capture.capture) ||
        (!problem.camera.intrinsics && estimate.camera.T_cam_board.contains(capture.capture)))
      blocks.push_back(capture.capture);
  return blocks;
}

Result<LidarCameraEstimate> SolvedAgain(const LidarCameraProblem& problem, const LidarCameraEstimate& start) {
  auto estimate = EstimateLidarCamera(problem, &start, nullptr);
  if (!estimate) return Fail(Reason(estimate.error()));
  return std::move(*estimate);
}

Result<LidarCameraEstimate> SolvedWithout(const LidarCameraProblem& problem, const LidarCameraEstimate& estimate,
                                          const CaptureId& capture) {
  LidarCameraEstimate start = estimate;
  start.patch_idx.erase(capture);
  if (!problem.camera.intrinsics) {
    auto camera = CameraAgain(problem, problem.camera, estimate, &capture);
    if (!camera) return Fail(Reason(camera.error()));
    start.camera = std::move(*camera);
  }
  return SolvedAgain(problem, start);
}

Result<LidarCameraEstimate> SolvedWithIntrinsic(const LidarCameraProblem& problem, const LidarCameraEstimate& estimate,
                                                std::size_t idx, double sigmas) {
  Sensor moved = problem.camera;
  CameraIntrinsics& k = *moved.intrinsics;
  (idx < 4 ? *std::array{&k.fx_px, &k.fy_px, &k.cx_px, &k.cy_px}[idx] : k.distortion[idx - 4]) +=
      sigmas * (*problem.camera.intrinsics_sigma)[idx];
  auto camera = CameraAgain(problem, moved, estimate, nullptr);
  if (!camera) return Fail(Reason(camera.error()));
  LidarCameraEstimate start = estimate;
  start.camera = std::move(*camera);
  return SolvedAgain(problem, start);
}

std::vector<std::size_t> UncertainIntrinsics(const LidarCameraProblem& problem) {
  std::vector<std::size_t> uncertain;
  if (!problem.camera.intrinsics || !problem.camera.intrinsics_sigma) return uncertain;
  for (std::size_t i = 0; i < problem.camera.intrinsics_sigma->size(); ++i)
    if ((*problem.camera.intrinsics_sigma)[i] > 0) uncertain.push_back(i);
  return uncertain;
}

}  // namespace rigcal::calib
