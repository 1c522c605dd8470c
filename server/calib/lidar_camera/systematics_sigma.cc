#include <algorithm>
#include <cmath>
#include <vector>

#include "server/base/parallel_for.h"
#include "server/calib/lidar_camera/lidar_camera_diagnoses.h"
#include "server/calib/lidar_camera/lidar_camera_variants.h"
#include "server/calib/lidar_camera/lidar_camera_work.h"
#include "server/calib/lidar_camera/systematics.h"

namespace rigcal::calib {
namespace {

// (range bias in metres, board scale ratio)
using Pair = Eigen::Vector2d;

// Of estimates near to one whose boards came out so much larger.
struct Nearby {
  const LidarCameraProblem& problem;
  double board_scale_ratio;

  [[nodiscard]] Result<Pair> PairOf(const Result<LidarCameraEstimate>& solved) const {
    if (!solved) return Fail(solved.error());
    const Systematics systematics = SystematicsNear(WorkOf(problem, *solved), board_scale_ratio);
    return Pair(systematics.range_bias_m, systematics.board_scale_ratio);
  }
};

template <typename Solve>
Result<std::vector<Pair>> PairsOf(const Nearby& nearby, std::size_t count, const Solve& solve) {
  std::vector<Result<Pair>> solved(count);
  ParallelFor(count, [&](std::size_t i) { solved[i] = nearby.PairOf(solve(i)); });
  std::vector<Pair> pairs;
  for (const Result<Pair>& one : solved) {
    if (!one) return Fail(one.error());
    pairs.push_back(*one);
  }
  return pairs;
}

Result<Pair> JackknifeVariance(const LidarCameraProblem& problem, const LidarCameraEstimate& estimate,
                               const std::vector<CaptureBlock>& blocks) {
  RIGCAL_ASSIGN(const std::vector<Pair> pairs,
                PairsOf({problem, estimate.board_scale_ratio}, blocks.size(),
                        [&](std::size_t i) { return SolvedWithout(problem, estimate, blocks[i].captures); }));
  const auto m = static_cast<double>(pairs.size());
  Pair mean = Pair::Zero(), variance = Pair::Zero();
  for (const Pair& pair : pairs) mean += pair / m;
  for (const Pair& pair : pairs) variance += (m - 1) / m * (pair - mean).cwiseAbs2();
  return variance;
}

// Of independent causes: `solve` with the i-th lower and larger by its sigma.
template <typename Solve>
Result<Pair> VarianceOf(const Nearby& nearby, std::size_t causes, const Solve& solve) {
  const auto moved = [&](std::size_t i) { return solve(i / 2, i % 2 == 0 ? -1.0 : 1.0); };
  RIGCAL_ASSIGN(const std::vector<Pair> pairs, PairsOf(nearby, 2 * causes, moved));
  Pair variance = Pair::Zero();
  for (std::size_t i = 0; i < causes; ++i) variance += (0.5 * (pairs[2 * i + 1] - pairs[2 * i])).cwiseAbs2();
  return variance;
}

Result<Pair> IntrinsicsVariance(const LidarCameraProblem& problem, const LidarCameraEstimate& estimate) {
  const std::vector<std::size_t> uncertain = UncertainIntrinsics(problem);
  return VarianceOf({problem, estimate.board_scale_ratio}, uncertain.size(), [&](std::size_t i, double sigmas) {
    return SolvedWithIntrinsic(problem, estimate, uncertain[i], sigmas);
  });
}

// Of the planes' points, which the estimate knows, and of the corners by way of refined intrinsics.
Result<Pair> ModelVariance(const LidarCameraProblem& problem, const LidarCameraEstimate& estimate) {
  const std::vector<IntrinsicsVector> changes = ChangesOfIntrinsics(problem, estimate);
  RIGCAL_ASSIGN(Pair variance,
                VarianceOf({problem, estimate.board_scale_ratio}, changes.size(), [&](std::size_t i, double sigmas) {
                  return SolvedWithChange(problem, estimate, sigmas * changes[i]);
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
