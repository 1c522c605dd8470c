#include "server/fleet/population/outliers.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

#include "server/fleet/population/spread.h"
#include "server/math/statistics.h"

namespace rigcal::fleet {
namespace {

constexpr double kSmallestSigma = 1e-6;  // m and rad: what is more alike is alike by rounding
constexpr double kSetAsideOdds = 1e-4;   // that any robot of a population of alike ones is set aside
constexpr std::size_t kRobotsToSetAside = 10;
constexpr double kMadEfficiency = 0.37;  // of a robust spread against that of normal values
constexpr double kAxes = 6.0;

std::vector<double> AxisOf(const std::vector<Vector6d>& offsets, Eigen::Index axis) {
  std::vector<double> values;
  values.reserve(offsets.size());
  for (const Vector6d& offset : offsets) values.push_back(offset[axis]);
  return values;
}

// In robust spreads.
double LimitOfSetAside(std::size_t robots) {
  const auto n = static_cast<double>(robots);
  const double one_sided = kSetAsideOdds / (2 * kAxes * n);
  return StudentQuantile(1.0 - one_sided, std::max(1.0, kMadEfficiency * n));
}

std::vector<bool> SetAside(const std::vector<Vector6d>& offsets, const std::vector<Matrix6d>& covariances) {
  std::vector<bool> aside(offsets.size(), false);
  if (offsets.size() < kRobotsToSetAside) return aside;
  const double limit = LimitOfSetAside(offsets.size());
  for (Eigen::Index axis = 0; axis < 6; ++axis) {
    const std::vector<double> values = AxisOf(offsets, axis);
    const double median = QuantileOf(values, 0.5), spread = std::max(RobustSpread(values, median), kSmallestSigma);
    for (std::size_t i = 0; i < values.size(); ++i) {
      const double sigma = std::sqrt(spread * spread + std::max(covariances[i](axis, axis), 0.0));
      if (std::abs(values[i] - median) > limit * sigma) aside[i] = true;
    }
  }
  return aside;
}

struct Moments {
  double count = 0.0;
  Vector6d mean = Vector6d::Zero();
  Matrix6d scatter = Matrix6d::Zero();  // sum of (x - mean) (x - mean)^T

  [[nodiscard]] Matrix6d Covariance() const {
    Matrix6d covariance = scatter / std::max(count - 1.0, 1.0);
    covariance.diagonal() = covariance.diagonal().cwiseMax(0.0).array() + kSmallestSigma * kSmallestSigma;
    return covariance;
  }
};

// Of all but those set aside.
Moments MomentsOf(const std::vector<Vector6d>& offsets, const std::vector<bool>& aside) {
  Moments moments;
  for (std::size_t i = 0; i < offsets.size(); ++i)
    if (!aside[i]) moments.count += 1.0, moments.mean += offsets[i];
  moments.mean /= std::max(moments.count, 1.0);
  for (std::size_t i = 0; i < offsets.size(); ++i)
    if (!aside[i]) moments.scatter += (offsets[i] - moments.mean) * (offsets[i] - moments.mean).transpose();
  return moments;
}

// As if that one, which is among them, had not been: a fleet of thousands is not walked through for each robot.
Moments Without(const Vector6d& offset, Moments moments) {
  const Vector6d d = offset - moments.mean;
  moments.scatter -= d * d.transpose() * (moments.count / std::max(moments.count - 1.0, 1.0));
  moments.mean -= d / std::max(moments.count - 1.0, 1.0);
  moments.count -= 1.0;
  return moments;
}

Distance AxisByAxis(const Vector6d& d, const Matrix6d& S, double others) {
  Distance distance{2.0, 0};
  for (std::size_t k = 0; k < 6; ++k) {
    const auto axis = static_cast<Eigen::Index>(k);
    const double odds = FisherTail(d[axis] * d[axis] / S(axis, axis), 1.0, others - 1.0);
    if (odds < distance.odds) distance = {odds, k};
  }
  distance.odds = std::min(1.0, kAxes * distance.odds);
  return distance;
}

Distance DistanceOf(const Vector6d& offset, const Matrix6d& own, const Moments& others) {
  if (!offset.allFinite() || !own.allFinite() || others.count < 2.0) return {};
  const Vector6d d = offset - others.mean;
  const Matrix6d S = others.Covariance() * (1.0 + 1.0 / others.count) + own;
  Distance distance = AxisByAxis(d, S, others.count);
  if (others.count < static_cast<double>(kOthersForDistance)) return distance;
  const Eigen::LLT<Matrix6d> root(S);
  if (root.info() != Eigen::Success) return distance;
  const double squared = root.matrixL().solve(d).squaredNorm(), nu = others.count - kAxes;
  distance.odds = FisherTail(squared * nu / (kAxes * (others.count - 1.0)), kAxes, nu);
  return distance;
}

}  // namespace

std::vector<Distance> DistancesFromOthers(const std::vector<Vector6d>& offsets,
                                          const std::vector<Matrix6d>& covariances) {
  const std::vector<bool> aside = SetAside(offsets, covariances);
  const Moments kept = MomentsOf(offsets, aside);
  std::vector<Distance> distances;
  for (std::size_t i = 0; i < offsets.size(); ++i)
    distances.push_back(DistanceOf(offsets[i], covariances[i], aside[i] ? kept : Without(offsets[i], kept)));
  return distances;
}

bool IsByDistance(std::size_t robots) { return robots > kOthersForDistance; }

}  // namespace rigcal::fleet
