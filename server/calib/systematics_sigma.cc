#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

#include "server/base/parallel_for.h"
#include "server/calib/lidar_camera_diagnoses.h"
#include "server/calib/lidar_camera_variants.h"
#include "server/calib/systematics.h"

namespace rigcal::calib {
namespace {

// (range bias in metres, board scale ratio)
using Pair = Eigen::Vector2d;

Pair PairOf(const LidarCameraEstimate& estimate) { return {estimate.range_bias_m, estimate.board_scale_ratio}; }

template <typename Solve>
Result<std::vector<Pair>> PairsOf(std::size_t count, const Solve& solve) {
  std::vector<std::optional<Result<LidarCameraEstimate>>> solved(count);
  ParallelFor(count, [&](std::size_t i) { solved[i] = solve(i); });
  std::vector<Pair> pairs;
  for (const auto& one : solved) {
    if (!*one) return Fail(one->error());
    pairs.push_back(PairOf(**one));
  }
  return pairs;
}

Result<Pair> JackknifeVariance(const LidarCameraProblem& problem, const LidarCameraEstimate& estimate) {
  const std::vector<CaptureId> captures = BlocksOf(problem, estimate);
  RIGCAL_ASSIGN(const std::vector<Pair> pairs,
                PairsOf(captures.size(), [&](std::size_t i) { return SolvedWithout(problem, estimate, captures[i]); }));
  const auto m = static_cast<double>(pairs.size());
  Pair mean = Pair::Zero(), variance = Pair::Zero();
  for (const Pair& pair : pairs) mean += pair / m;
  for (const Pair& pair : pairs) variance += (m - 1) / m * (pair - mean).cwiseAbs2();
  return variance;
}

Result<Pair> IntrinsicsVariance(const LidarCameraProblem& problem, const LidarCameraEstimate& estimate) {
  const std::vector<std::size_t> uncertain = UncertainIntrinsics(problem);
  RIGCAL_ASSIGN(const std::vector<Pair> pairs, PairsOf(2 * uncertain.size(), [&](std::size_t i) {
                  return SolvedWithIntrinsic(problem, estimate, uncertain[i / 2], i % 2 == 0 ? -1.0 : 1.0);
                }));
  Pair variance = Pair::Zero();
  for (std::size_t i = 0; i < uncertain.size(); ++i) variance += (0.5 * (pairs[2 * i + 1] - pairs[2 * i])).cwiseAbs2();
  return variance;
}

double Widened(double sigma, double jackknife_variance, double given_variance) {
  return std::sqrt(std::max(sigma * sigma, jackknife_variance) + given_variance);
}

}  // namespace

Status WidenSystematics(const LidarCameraProblem& problem, LidarCameraEstimate& estimate) {
  if (estimate.patch_idx.size() < kLidarCapturesForJackknife) return {};
  RIGCAL_ASSIGN(const Pair captures, JackknifeVariance(problem, estimate));
  RIGCAL_ASSIGN(const Pair given, IntrinsicsVariance(problem, estimate));
  estimate.range_bias_sigma_m = Widened(estimate.range_bias_sigma_m, captures[0], given[0]);
  estimate.board_scale_sigma_ratio = Widened(estimate.board_scale_sigma_ratio, captures[1], given[1]);
  return {};
}

}  // namespace rigcal::calib
