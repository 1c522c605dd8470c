#include "server/calib/lidar_camera/lidar_camera_work.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <limits>

#include "server/calib/camera/intrinsics.h"
#include "server/calib/core/leave_one_out.h"
#include "server/calib/core/robust.h"
#include "server/calib/lidar_camera/lidar_camera_diagnoses.h"

namespace rigcal::calib {
namespace {

constexpr double kSmallestVariance_px2 = 1e-4;  // of perfect data: weights stay finite
constexpr double kTypicalPlaneSigma_m = 0.01;
constexpr double kFewCapturesSigma_m = 0.003;  // flatness, scene and beam errors of real lidars

PlaneCapture PlaneOf(const CameraEstimate& camera, const CaptureId& capture, const PlaneMoments& moments) {
  PlaneCapture plane;
  plane.T_cam_board = camera.T_cam_board.at(capture);
  plane.camera_information = camera.information.at(capture) / std::max(camera.variance_px2, kSmallestVariance_px2);
  plane.moments = moments;
  return plane;
}

// The sigma that, added to each capture's own, makes the residuals as large as they are in the middle; 0 if they are no
// larger.
double ExtraSigma(const std::vector<double>& residuals, const std::vector<double>& sigmas) {
  const auto typical = [&](double extra) {
    std::vector<double> ratios;
    for (std::size_t k = 0; k < residuals.size(); ++k)
      ratios.push_back(kMadSigma * std::abs(residuals[k]) / std::hypot(sigmas[k], extra));
    return MedianOf(ratios);
  };
  double low = 0, high = 2 * kMadSigma * *std::max_element(residuals.begin(), residuals.end());
  if (!(typical(0) > 1)) return 0;
  for (int halving = 0; halving < 60; ++halving) {
    const double middle = (low + high) / 2;
    (typical(middle) > 1 ? low : high) = middle;
  }
  return high;
}

Error Reason(const Diagnosis& diagnosis) { return {ErrorCode::kInvalidInput, diagnosis.what, diagnosis.cure}; }

// Poses of the boards and intrinsics from the other pictures.
OrDiagnosis<CameraEstimate> CameraWithout(const LidarCameraProblem& problem, const LidarCameraEstimate& estimate,
                                          const std::set<CaptureId>& without) {
  CameraProblem camera{problem.camera, problem.board, {}};
  for (const LidarCameraCapture& capture : problem.captures) {
    if (!estimate.camera.T_cam_board.contains(capture.capture)) continue;
    if (!without.contains(capture.capture)) camera.views.emplace_back(capture.capture, *capture.view);
  }
  return EstimateCamera(camera, &estimate.camera);
}

}  // namespace

PlaneState LidarCameraWork::StateOf() const {
  PlaneState state{T_cam_lidar, range_bias_m, {}, held};
  for (const PlaneCapture& plane : planes) state.T_cam_board.push_back(plane.T_cam_board);
  return state;
}

void LidarCameraWork::Drop(std::size_t position, const std::string& why) {
  unused[used[position].capture_idx] = why;
  EraseAt(position, used, planes);
  if (position < solution.state.T_cam_board.size()) EraseAt(position, solution.state.T_cam_board);
}

std::string WhyUseless(const LidarCameraProblem& problem, const CameraEstimate& camera, std::size_t capture_idx) {
  const LidarCameraCapture& capture = problem.captures[capture_idx];
  const std::string eye = problem.camera.id.str() + ": ", beam = problem.lidar.id.str() + ": ";
  if (!capture.view) return eye + "no picture";
  if (!capture.view->found) return eye + capture.view->why_not;
  if (!capture.cloud) return beam + "no cloud";
  if (!capture.cloud->found) return beam + capture.cloud->why_not;
  return camera.T_cam_board.contains(capture.capture) ? std::string()
                                                      : eye + "no pose of the board explains the picture";
}

void FillPlanes(const LidarCameraProblem& problem, LidarCameraWork& work) {
  std::vector<const PlanePatch*> patches;
  for (const UsedPatch& used : work.used)
    patches.push_back(&problem.captures[used.capture_idx].cloud->candidates[used.patch_idx]);
  work.range_sigma_m = RangeSigma_m(patches);
  work.planes.clear();
  for (std::size_t k = 0; k < patches.size(); ++k)
    work.planes.push_back(PlaneOf(work.camera, problem.captures[work.used[k].capture_idx].capture,
                                  MomentsOf(*patches[k], work.range_sigma_m)));
}

LidarCameraWork WorkOf(const LidarCameraProblem& problem, const LidarCameraEstimate& estimate) {
  LidarCameraWork work;
  work.camera = estimate.camera;
  work.T_cam_lidar = estimate.T_cam_lidar;
  work.range_bias_m = problem.range_bias_m;
  work.range_sigma_m = estimate.range_sigma_m;
  work.capture_sigma_m = estimate.capture_sigma_m;
  work.held = estimate.held;
  const double shared_m2 = work.capture_sigma_m * work.capture_sigma_m;
  for (std::size_t idx = 0; idx < problem.captures.size(); ++idx) {
    const CaptureId& capture = problem.captures[idx].capture;
    const auto patch = estimate.patch_idx.find(capture);
    if (patch == estimate.patch_idx.end()) {
      work.unused[idx] = "not in the estimate that this one starts from";
      continue;
    }
    work.used.push_back({idx, patch->second});
    work.planes.push_back(PlaneOf(work.camera, capture, estimate.moments.at(capture)));
    work.planes.back().factor = 1 / (1 + shared_m2 * work.planes.back().moments.weight_per_m2);
  }
  return work;
}

LidarCameraCheck CheckOf(const LidarCameraProblem& problem, const LidarCameraWork& work, std::size_t position) {
  const UsedPatch& used = work.used[position];
  const PlanePatch& patch = problem.captures[used.capture_idx].cloud->candidates[used.patch_idx];
  // Against the board as the picture alone puts it: the joint pose would hide what the two disagree about.
  const PlaneState state{work.T_cam_lidar, work.range_bias_m, {work.planes[position].T_cam_board}, {}};
  const Vector7d g = PlaneInLidar(state, 0);
  return {MeanDistance_m(work.planes[position], g), AngleBetween_rad(g.head<3>(), patch.normal), patch.points_m.size()};
}

// Points of one capture share errors (range bias of the surface, bent boards): a capture does not count without bound
// because it has many points. The shared part is what the captures' mean distances show beyond the noise of points and
// pictures.
void Reweigh(const LidarCameraProblem& problem, LidarCameraWork& work) {
  std::vector<double> distances_m, sigmas_m;
  PlaneState state = work.StateOf();
  for (std::size_t k = 0; k < work.planes.size(); ++k) {
    distances_m.push_back(std::abs(CheckOf(problem, work, k).distance_m));
    sigmas_m.push_back(MeanDistanceSigma_m(work.planes[k], state, k));
  }
  // A few captures may fit by luck: what they share is then taken from experience.
  const double least_m = work.planes.size() < kLidarCapturesEnough ? kFewCapturesSigma_m : 0.0;
  work.capture_sigma_m = std::max(least_m, ExtraSigma(distances_m, sigmas_m));
  for (PlaneCapture& plane : work.planes)
    plane.factor = 1 / (1 + work.capture_sigma_m * work.capture_sigma_m * plane.moments.weight_per_m2);
}

NormalSpread SpreadOf(const std::vector<PlaneCapture>& planes) {
  Eigen::Matrix3d sum = Eigen::Matrix3d::Zero();
  double cone_rad = 0;
  for (const PlaneCapture& left : planes) {
    const Eigen::Vector3d normal = left.T_cam_board.R().col(2);
    sum += normal * normal.transpose();
    for (const PlaneCapture& right : planes)
      cone_rad = std::max(cone_rad, AngleBetween_rad(normal, right.T_cam_board.R().col(2)));
  }
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(sum);
  const auto sigma_m = [&](int i) {
    const double sum_of_squares = solver.eigenvalues()[i];
    return sum_of_squares > 0 ? kTypicalPlaneSigma_m / std::sqrt(sum_of_squares)
                              : std::numeric_limits<double>::infinity();
  };
  return {cone_rad * 180 / M_PI, sigma_m(0), sigma_m(1), solver.eigenvectors().col(0)};
}

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

Result<LidarCameraEstimate> SolvedWithCamera(const LidarCameraProblem& problem, const LidarCameraEstimate& estimate,
                                             CameraEstimate camera) {
  LidarCameraEstimate start = estimate;
  start.camera = std::move(camera);
  return SolvedAgain(problem, start);
}

std::vector<IntrinsicsVector> ChangesOfIntrinsics(const LidarCameraProblem& problem,
                                                  const LidarCameraEstimate& estimate) {
  if (HoldsIntrinsics(problem.camera)) return {};
  return ChangesByCorners(estimate.camera);
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
