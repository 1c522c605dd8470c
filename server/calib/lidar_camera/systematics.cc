#include "server/calib/lidar_camera/systematics.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

namespace rigcal::calib {
namespace {

constexpr int kRounds = 4;
constexpr double kScaleStep_ratio = 1e-3;

struct Fit {
  double value = 0, sigma = 0;
  double rms_m = 0;  // of the captures' mean distances with it
};

double RmsOf(const LidarCameraProblem& problem, const LidarCameraWork& work) {
  double sum_m2 = 0;
  for (std::size_t k = 0; k < work.used.size(); ++k) sum_m2 += std::pow(CheckOf(problem, work, k).distance_m, 2);
  return std::sqrt(sum_m2 / static_cast<double>(work.used.size()));
}

Fit FitRangeBias(const LidarCameraProblem& problem, LidarCameraWork work) {
  Fit fit;
  for (int round = 0; round < kRounds; ++round) {
    const auto solution = SolvePlanes(work.planes, work.StateOf(), true);
    if (!solution) return fit;
    work.T_cam_lidar = solution->state.T_cam_lidar;
    work.range_bias_m = solution->state.range_bias_m;
    const Matrix7d covariance = solution->information.inverse();
    fit = {work.range_bias_m, std::sqrt(std::max(0.0, covariance(6, 6))), RmsOf(problem, work)};
    Reweigh(problem, work);
  }
  return fit;
}

void Scale(double ratio, LidarCameraWork& work) {
  for (PlaneCapture& plane : work.planes) plane.T_cam_board.p_m *= 1 + ratio;
}

std::optional<PlaneSolution> SolveScaled(LidarCameraWork work, double ratio) {
  Scale(ratio, work);
  auto solution = SolvePlanes(work.planes, work.StateOf(), false);
  return solution ? std::optional(std::move(*solution)) : std::nullopt;
}

struct ScaleStep {
  double ratio = 0, sigma_ratio = 0;
};

// A Newton step on the least cost as a function of the scale; its curvature is the information.
std::optional<ScaleStep> StepOfScale(const LidarCameraWork& work) {
  const auto less = SolveScaled(work, -kScaleStep_ratio), same = SolveScaled(work, 0),
             more = SolveScaled(work, kScaleStep_ratio);
  if (!less || !same || !more) return std::nullopt;
  const double slope = (more->cost - less->cost) / (2 * kScaleStep_ratio);
  const double curvature = (more->cost - 2 * same->cost + less->cost) / (kScaleStep_ratio * kScaleStep_ratio);
  if (!(curvature > 0)) return std::nullopt;
  return ScaleStep{std::clamp(-slope / curvature, -0.1, 0.1), std::sqrt(2 / curvature)};
}

Fit FitBoardScale(const LidarCameraProblem& problem, LidarCameraWork work) {
  Fit fit;
  for (int round = 0; round < kRounds; ++round) {
    const auto step = StepOfScale(work);
    if (!step) return {};
    Scale(step->ratio, work);
    fit.value = (1 + fit.value) * (1 + step->ratio) - 1;
    fit.sigma = step->sigma_ratio;
    const auto solution = SolvePlanes(work.planes, work.StateOf(), false);
    if (!solution) return {};
    work.T_cam_lidar = solution->state.T_cam_lidar;
    fit.rms_m = RmsOf(problem, work);
    Reweigh(problem, work);
  }
  return fit;
}

}  // namespace

Systematics SystematicsNear(LidarCameraWork work, double board_scale_ratio) {
  constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();
  const auto with_bias = SolvePlanes(work.planes, work.StateOf(), true);
  Scale(board_scale_ratio, work);
  const auto step = StepOfScale(work);
  return {with_bias ? with_bias->state.range_bias_m : kUnknown,
          step ? (1 + board_scale_ratio) * (1 + step->ratio) - 1 : kUnknown};
}

void EstimateSystematics(const LidarCameraProblem& problem, const LidarCameraWork& work,
                         LidarCameraEstimate& estimate) {
  const Fit bias = FitRangeBias(problem, work), scale = FitBoardScale(problem, work);
  estimate.range_bias_m = bias.value;
  estimate.range_bias_sigma_m = bias.sigma;
  estimate.board_scale_ratio = scale.value;
  estimate.board_scale_sigma_ratio = scale.sigma;
  estimate.scale_fits_better = scale.sigma > 0 && scale.rms_m < bias.rms_m;
}

}  // namespace rigcal::calib
