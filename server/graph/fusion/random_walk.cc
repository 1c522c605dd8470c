#include "server/graph/fusion/random_walk.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace rigcal::graph {
namespace {

constexpr std::size_t kVisitsMin = 6;  // of fewer nearly all that is said of q would be the prior
// Sizes in powers of two of what the visits show: of the walk over all their days, and of v.
constexpr int kWalkLeast = -8, kWalkMost = 2, kNoiseLeast = -8, kNoiseMost = 0;

// One axis of the visits, oldest first; `days`: since the one before.
struct Series {
  std::vector<double> e, own, days;
};

// Of the innovations, but for a constant. The first visit tells where the walk begins.
double LogLikelihood(const Series& series, double walk, double noise) {
  double place = series.e.front(), variance = series.own.front() + noise, sum = 0.0;
  for (std::size_t k = 1; k < series.e.size(); ++k) {
    variance += walk * series.days[k];
    const double innovation = series.e[k] - place, expected = variance + series.own[k] + noise;
    if (!(expected > 0)) return -std::numeric_limits<double>::infinity();
    sum -= 0.5 * (std::log(expected) + innovation * innovation / expected);
    place += variance / expected * innovation;
    variance *= (series.own[k] + noise) / expected;
  }
  return sum;
}

std::vector<Series> AxesOf(const std::vector<VisitResidual>& visits, int part) {
  std::vector<Series> axes(3);
  double age_days = visits.back().age_days;
  for (auto visit = visits.rbegin(); visit != visits.rend(); ++visit) {
    for (int axis = 0; axis < 3; ++axis) {
      Series& series = axes[static_cast<std::size_t>(axis)];
      series.e.push_back(visit->e(part + axis));
      series.own.push_back(std::max(0.0, visit->own(part + axis, part + axis)));
      series.days.push_back(std::max(0.0, age_days - visit->age_days));
    }
    age_days = visit->age_days;
  }
  return axes;
}

// Mean variance of an axis: what visits err by and what they show.
double ShownBy(const std::vector<Series>& axes) {
  double shown = 0.0;
  for (const Series& axis : axes) {
    const auto count = static_cast<double>(axis.e.size());
    double mean = 0.0;
    for (const double e : axis.e) mean += e / count;
    for (std::size_t k = 0; k < axis.e.size(); ++k)
      shown += (axis.own[k] + (axis.e[k] - mean) * (axis.e[k] - mean)) / (3.0 * count);
  }
  return shown;
}

// Of one size of the walk, over all sizes of v: log of the sum of the likelihoods.
double LogEvidence(const std::vector<Series>& axes, double walk, double shown) {
  std::vector<double> logs;
  for (int size = kNoiseLeast - 1; size <= kNoiseMost; ++size) {
    const double noise = size < kNoiseLeast ? 0.0 : shown * std::exp2(size);
    double log = 0.0;
    for (const Series& axis : axes) log += LogLikelihood(axis, walk, noise);
    logs.push_back(log);
  }
  const double most = *std::max_element(logs.begin(), logs.end());
  double sum = 0.0;
  for (const double log : logs) sum += std::isfinite(log) ? std::exp(log - most) : 0.0;
  return most + std::log(sum);
}

struct Variance {
  double mean = 0.0, dof = 0.0;
};

// Of sizes of these log likelihoods.
Variance MeanOf(const std::vector<double>& logs, double unit) {
  const double most = *std::max_element(logs.begin(), logs.end());
  double weights = 0.0, sizes = 0.0, squares = 0.0;
  for (std::size_t j = 0; j < logs.size(); ++j) {
    const double weight = std::exp(logs[j] - most), size = std::exp2(kWalkLeast + static_cast<double>(j));
    weights += weight, sizes += weight * size, squares += weight * size * size;
  }
  const double mean = sizes / weights, variance = squares / weights - mean * mean;
  if (!std::isfinite(mean)) return {};
  return {unit * mean, variance > 0 ? 2 * mean * mean / variance : std::numeric_limits<double>::max()};
}

Variance WalkAlong(const std::vector<VisitResidual>& visits, int part) {
  const std::vector<Series> axes = AxesOf(visits, part);
  const double days = visits.back().age_days - visits.front().age_days, shown = ShownBy(axes);
  if (!(days > 0) || !(shown > 0)) return {};
  std::vector<double> logs;
  for (int size = kWalkLeast; size <= kWalkMost; ++size)
    logs.push_back(LogEvidence(axes, shown * std::exp2(size) / days, shown));
  return MeanOf(logs, shown / days);
}

// Takes it out of one axis; how many places that are.
double TakeWalkOut(std::vector<VisitResidual>& visits, int axis, double per_day, double scatter) {
  const auto count = static_cast<Eigen::Index>(visits.size());
  Eigen::VectorXd e(count), R(count);
  Eigen::MatrixXd C(count, count);
  for (Eigen::Index k = 0; k < count; ++k) {
    const VisitResidual& visit = visits[static_cast<std::size_t>(k)];
    e(k) = visit.e(axis);
    R(k) = std::max(0.0, visit.own(axis, axis)) + scatter;
    for (Eigen::Index l = 0; l < count; ++l)
      C(k, l) =
          per_day * (visits.back().age_days - std::max(visit.age_days, visits[static_cast<std::size_t>(l)].age_days));
    C(k, k) += R(k);
  }
  if (!(R.minCoeff() > 0)) return 1.0;
  const Eigen::MatrixXd M = C.llt().solve(Eigen::MatrixXd::Identity(count, count));
  const Eigen::VectorXd of_all = M.rowwise().sum();
  const Eigen::MatrixXd P = M - of_all * of_all.transpose() / of_all.sum();
  const Eigen::VectorXd rest = R.asDiagonal() * (P * e);
  for (Eigen::Index k = 0; k < count; ++k) visits[static_cast<std::size_t>(k)].e(axis) = rest(k);
  return static_cast<double>(count) - R.dot(P.diagonal());
}

}  // namespace

Walk WalkOf(const std::vector<VisitResidual>& visits) {
  if (visits.size() < kVisitsMin) return {};
  const Variance shifts = WalkAlong(visits, tangent::kTranslation), turns = WalkAlong(visits, tangent::kRotation);
  return {{shifts.mean, turns.mean}, {shifts.dof, turns.dof}};
}

AboutWalk LessWalk(std::vector<VisitResidual> visits, const VisitVariance& per_day, const VisitVariance& scatter) {
  AboutWalk about{std::move(visits), {}};
  const Vector6d walk = per_day.Matrix().diagonal(), v = scatter.Matrix().diagonal();
  const auto means_of = [&](int part) {
    double means = 0.0;
    for (int axis = part; axis < part + 3; ++axis)
      means += walk(axis) > 0 ? TakeWalkOut(about.visits, axis, walk(axis), v(axis)) / 3.0 : 1.0 / 3.0;
    return means;
  };
  about.means.translation = means_of(tangent::kTranslation);
  about.means.rotation = means_of(tangent::kRotation);
  return about;
}

}  // namespace rigcal::graph
