#include "server/calib/lidar_camera/lidar_camera_variants.h"

#include "server/calib/camera/intrinsics_variants.h"

namespace rigcal::calib {
namespace {

Error Reason(const Diagnosis& diagnosis) { return {ErrorCode::kInvalidInput, diagnosis.what, diagnosis.cure}; }

// Poses of the boards and intrinsics from the other pictures.
tl::expected<CameraEstimate, Diagnosis> CameraWithout(const LidarCameraProblem& problem,
                                                      const LidarCameraEstimate& estimate,
                                                      const std::set<CaptureId>& without) {
  CameraProblem camera{problem.camera, problem.board, {}};
  for (const LidarCameraCapture& capture : problem.captures) {
    if (!estimate.camera.T_cam_board.contains(capture.capture)) continue;
    if (!without.contains(capture.capture)) camera.views.emplace_back(capture.capture, *capture.view);
  }
  return EstimateCamera(camera, &estimate.camera);
}

}  // namespace

std::vector<CaptureBlock> BlocksOf(const LidarCameraProblem& problem, const LidarCameraEstimate& estimate) {
  std::set<CaptureId> used;
  for (const auto& [capture, patch] : estimate.patch_idx) used.insert(capture);
  if (!HoldsIntrinsics(problem.camera))
    for (const auto& [capture, pose] : estimate.camera.T_cam_board) used.insert(capture);
  return CaptureBlocks(problem.session_captures, used);
}

std::size_t CarryingBlocks(const std::vector<CaptureBlock>& blocks, const LidarCameraEstimate& estimate) {
  std::set<CaptureId> both;
  for (const auto& [capture, patch] : estimate.patch_idx) both.insert(capture);
  return CountWith(blocks, both);
}

Result<LidarCameraEstimate> SolvedAgain(const LidarCameraProblem& problem, const LidarCameraEstimate& start) {
  auto estimate = EstimateLidarCamera(problem, &start, nullptr);
  if (!estimate) return Fail(Reason(estimate.error()));
  return std::move(*estimate);
}

Result<LidarCameraEstimate> SolvedWithout(const LidarCameraProblem& problem, const LidarCameraEstimate& estimate,
                                          const std::set<CaptureId>& captures) {
  LidarCameraEstimate start = estimate;
  for (const CaptureId& capture : captures) start.patch_idx.erase(capture);
  if (RefinesIntrinsics(problem.camera)) {
    start.camera = WithoutViews(estimate.camera, captures);
  } else if (!problem.camera.intrinsics) {
    auto camera = CameraWithout(problem, estimate, captures);
    if (!camera) return Fail(Reason(camera.error()));
    start.camera = std::move(*camera);
  }
  return SolvedAgain(problem, start);
}

Result<LidarCameraEstimate> SolvedWithIntrinsic(const LidarCameraProblem& problem, const LidarCameraEstimate& estimate,
                                                std::size_t idx, double sigmas) {
  LidarCameraEstimate start = estimate;
  start.camera = WithGiven(estimate.camera, static_cast<int>(idx), sigmas);
  return SolvedAgain(problem, start);
}

std::vector<IntrinsicsVector> ChangesOfIntrinsics(const LidarCameraProblem& problem,
                                                  const LidarCameraEstimate& estimate) {
  if (HoldsIntrinsics(problem.camera)) return {};
  return ChangesByCorners(estimate.camera);
}

Result<LidarCameraEstimate> SolvedWithChange(const LidarCameraProblem& problem, const LidarCameraEstimate& estimate,
                                             const IntrinsicsVector& change) {
  LidarCameraEstimate start = estimate;
  start.camera = WithIntrinsicsMoved(estimate.camera, change);
  return SolvedAgain(problem, start);
}

std::vector<std::size_t> UncertainIntrinsics(const LidarCameraProblem& problem) {
  const std::vector<int> refined = RefinedOf(problem.camera);
  return {refined.begin(), refined.end()};
}

std::vector<char> BeamsSeen(const LidarCameraProblem& problem, const LidarCameraEstimate& estimate) {
  std::vector<char> seen(kBeamGroups, 0);
  for (const LidarCameraCapture& capture : problem.captures)
    if (const auto used = estimate.patch_idx.find(capture.capture); used != estimate.patch_idx.end())
      MarkBeams(capture.cloud->candidates[used->second], seen);
  return seen;
}

Result<LidarCameraEstimate> SolvedWithBeamsMoved(const LidarCameraProblem& problem, const LidarCameraEstimate& estimate,
                                                 std::size_t group, double longer_m) {
  LidarCameraEstimate start = estimate;
  for (const LidarCameraCapture& capture : problem.captures) {
    const auto used = estimate.patch_idx.find(capture.capture);
    if (used == estimate.patch_idx.end()) continue;
    const PlanePatch patch = WithBeamsMoved(capture.cloud->candidates[used->second], group, longer_m);
    start.moments[capture.capture] = MomentsOf(patch, estimate.range_sigma_m);
  }
  return SolvedAgain(problem, start);
}

}  // namespace rigcal::calib
