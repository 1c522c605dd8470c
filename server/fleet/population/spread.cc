#include "server/fleet/population/spread.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace rigcal::fleet {
namespace {

constexpr double kSigmaOfMad = 1.482602218505602;  // 1 / the normal's upper quartile
constexpr double kQuarter = 0.25, kHalf = 0.5;
constexpr std::size_t kStartsTried = 32;

// One that is turned like most: logarithms about a pose that is upside down (a sensor mounted so) are half turns of
// either sign, whose medians say nothing. A few of many are tried: most of them are alike.
const Se3& TurnedLikeMost(const std::vector<Se3>& poses) {
  const std::size_t step = (poses.size() + kStartsTried - 1) / kStartsTried;
  const Se3* best = &poses.front();
  double least_rad = std::numeric_limits<double>::infinity();
  for (std::size_t tried = 0; tried < poses.size(); tried += step) {
    std::vector<double> turns_rad;
    for (const Se3& pose : poses) turns_rad.push_back(poses[tried].q.angularDistance(pose.q));
    const double turn_rad = QuantileOf(std::move(turns_rad), kHalf);
    if (turn_rad < least_rad) least_rad = turn_rad, best = &poses[tried];
  }
  return *best;
}

}  // namespace

double QuantileOf(std::vector<double> values, double part) {
  std::sort(values.begin(), values.end());
  const double at = part * static_cast<double>(values.size() - 1);
  const auto below = static_cast<std::size_t>(at);
  const double above = values[std::min(below + 1, values.size() - 1)];
  return values[below] + (at - static_cast<double>(below)) * (above - values[below]);
}

double RobustSpread(const std::vector<double>& values, double median) {
  std::vector<double> away;
  away.reserve(values.size());
  for (const double value : values) away.push_back(std::abs(value - median));
  return kSigmaOfMad * QuantileOf(std::move(away), kHalf);
}

AxisSpread SpreadOf(const std::vector<double>& values) {
  AxisSpread axis;
  axis.min = QuantileOf(values, 0.0);
  axis.lower = QuantileOf(values, kQuarter);
  axis.median = QuantileOf(values, kHalf);
  axis.upper = QuantileOf(values, 1.0 - kQuarter);
  axis.max = QuantileOf(values, 1.0);
  axis.spread = RobustSpread(values, axis.median);
  return axis;
}

Se3 MedianPose(const std::vector<Se3>& poses) {
  constexpr int kRounds = 8;  // each leaves a few hundredths of what was left, of poses that turn by 0.1 rad
  Se3 center = TurnedLikeMost(poses);
  for (int round = 0; round < kRounds; ++round) {
    std::array<std::vector<double>, 6> axes;
    for (const Se3& pose : poses) {
      const Vector6d offset = (center.Inverse() * pose).Log();
      for (std::size_t axis = 0; axis < 6; ++axis) axes[axis].push_back(offset[static_cast<Eigen::Index>(axis)]);
    }
    Vector6d median;
    for (std::size_t axis = 0; axis < 6; ++axis)
      median[static_cast<Eigen::Index>(axis)] = QuantileOf(axes[axis], kHalf);
    center = (center * Se3::Exp(median)).Normalized();
  }
  return center;
}

}  // namespace rigcal::fleet
