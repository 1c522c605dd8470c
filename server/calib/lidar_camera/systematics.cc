#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <vector>

#include "server/base/process/parallel_for.h"
#include "server/calib/camera/intrinsics.h"
#include "server/calib/core/leave_one_out.h"
#include "server/calib/lidar_camera/lidar_camera_diagnoses.h"
#include "server/calib/lidar_camera/lidar_camera_work.h"

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
  auto solution = SolvePlanes(work.planes, work.StateOf(), false, kLinearAgain_ratio);
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

// (range bias in metres, board scale ratio)
using Pair = Eigen::Vector2d;

// Of an estimate solved again, with its weights: one step from a known scale. NaN: it cannot tell.
Pair SystematicsNear(LidarCameraWork work, double board_scale_ratio) {
  constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();
  const auto with_bias = SolvePlanes(work.planes, work.StateOf(), true, kLinearAgain_ratio);
  Scale(board_scale_ratio, work);
  const auto step = StepOfScale(work);
  return {with_bias ? with_bias->state.range_bias_m : kUnknown,
          step ? (1 + board_scale_ratio) * (1 + step->ratio) - 1 : kUnknown};
}

// Of estimates near to `estimate`: what `solve(i)` gives.
template <typename Solve>
Result<std::vector<Pair>> PairsOf(const LidarCameraProblem& problem, const LidarCameraEstimate& estimate,
                                  std::size_t count, const Solve& solve) {
  std::vector<Result<Pair>> solved(count);
  ParallelFor(count, [&](std::size_t i) {
    solved[i] = solve(i).map([&](const LidarCameraEstimate& one) {
      return SystematicsNear(WorkOf(problem, one), estimate.board_scale_ratio);
    });
  });
  std::vector<Pair> pairs;
  for (const Result<Pair>& one : solved) {
    if (!one) return Fail(one.error());
    pairs.push_back(*one);
  }
  return pairs;
}

Result<Pair> JackknifeVariance(const LidarCameraProblem& problem, const LidarCameraEstimate& estimate,
                               const std::vector<CaptureBlock>& blocks) {
  RIGCAL_ASSIGN(const std::vector<Pair> pairs, PairsOf(problem, estimate, blocks.size(), [&](std::size_t i) {
                  return SolvedWithout(problem, estimate, blocks[i].captures);
                }));
  const auto m = static_cast<double>(pairs.size());
  Pair mean = Pair::Zero(), variance = Pair::Zero();
  for (const Pair& pair : pairs) mean += pair / m;
  for (const Pair& pair : pairs) variance += (m - 1) / m * (pair - mean).cwiseAbs2();
  return variance;
}

// Of independent causes: `solve` with the i-th lower and larger by its sigma.
template <typename Solve>
Result<Pair> VarianceOf(const LidarCameraProblem& problem, const LidarCameraEstimate& estimate, std::size_t causes,
                        const Solve& solve) {
  const auto moved = [&](std::size_t i) { return solve(i / 2, i % 2 == 0 ? -1.0 : 1.0); };
  RIGCAL_ASSIGN(const std::vector<Pair> pairs, PairsOf(problem, estimate, 2 * causes, moved));
  Pair variance = Pair::Zero();
  for (std::size_t i = 0; i < causes; ++i) variance += (0.5 * (pairs[2 * i + 1] - pairs[2 * i])).cwiseAbs2();
  return variance;
}

Result<Pair> IntrinsicsVariance(const LidarCameraProblem& problem, const LidarCameraEstimate& estimate) {
  const std::vector<int> uncertain = RefinedOf(problem.camera);
  return VarianceOf(problem, estimate, uncertain.size(), [&](std::size_t i, double sigmas) {
    return SolvedWithCamera(problem, estimate, WithGiven(estimate.camera, uncertain[i], sigmas));
  });
}

// Of the planes' points, which the estimate knows, and of the corners by way of refined intrinsics.
Result<Pair> ModelVariance(const LidarCameraProblem& problem, const LidarCameraEstimate& estimate) {
  const std::vector<IntrinsicsVector> changes = ChangesOfIntrinsics(problem, estimate);
  RIGCAL_ASSIGN(Pair variance, VarianceOf(problem, estimate, changes.size(), [&](std::size_t i, double sigmas) {
                  return SolvedWithCamera(problem, estimate, WithIntrinsicsMoved(estimate.camera, sigmas * changes[i]));
                }));
  variance += Pair(estimate.range_bias_sigma_m, estimate.board_scale_sigma_ratio).cwiseAbs2();
  return variance;
}

// NaN if one of them is.
double Larger(double a, double b) { return std::isnan(a + b) ? a + b : std::max(a, b); }

// Neither is known: with one of them left open the other would be blamed for both.
void Forget(LidarCameraEstimate& estimate) {
  estimate.range_bias_m = estimate.range_bias_sigma_m = 0;
  estimate.board_scale_ratio = estimate.board_scale_sigma_ratio = 0;
  estimate.scale_fits_better = false;
}

}  // namespace

void EstimateSystematics(const LidarCameraProblem& problem, const LidarCameraWork& work,
                         LidarCameraEstimate& estimate) {
  const Fit bias = FitRangeBias(problem, work), scale = FitBoardScale(problem, work);
  estimate.range_bias_m = bias.value;
  estimate.range_bias_sigma_m = bias.sigma;
  estimate.board_scale_ratio = scale.value;
  estimate.board_scale_sigma_ratio = scale.sigma;
  estimate.scale_fits_better = scale.sigma > 0 && scale.rms_m < bias.rms_m;
}

Status WidenSystematics(const LidarCameraProblem& problem, LidarCameraEstimate& estimate) {
  RIGCAL_ASSIGN(Pair variance, ModelVariance(problem, estimate));
  const std::vector<CaptureBlock> blocks = BlocksOf(problem, estimate);
  if (CarryingBlocks(blocks, estimate) >= kLidarCapturesForJackknife) {
    RIGCAL_ASSIGN(const Pair shown, JackknifeVariance(problem, estimate, blocks));
    variance = variance.binaryExpr(shown, &Larger);
  }
  RIGCAL_ASSIGN(const Pair given, IntrinsicsVariance(problem, estimate));
  variance += given;
  if (!variance.allFinite() || !estimate.KnowsSystematics()) {
    Forget(estimate);
    return {};
  }
  estimate.range_bias_sigma_m = std::sqrt(variance[0]);
  estimate.board_scale_sigma_ratio = std::sqrt(variance[1]);
  return {};
}

}  // namespace rigcal::calib
