#include "server/graph/fusion/random_walk.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace rigcal::graph {
namespace {

constexpr std::size_t kVisitsMin = 6;
// Sizes of the walk over all days and of v, in powers of two: from so little of what the surest axis shows on ...
constexpr int kSizeLeast = -8, kSizesMax = 48;
constexpr double kWalkMost = 4.0;  // ... to so much of what any axis shows beyond its own errors; v to as much

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

// Variances of an axis: what visits err by on average, and what they show about their mean.
struct Shown {
  double own = 0.0, spread = 0.0;
};
Shown ShownBy(const Series& axis) {
  const auto count = static_cast<double>(axis.e.size());
  Shown shown;
  double mean = 0.0;
  for (const double e : axis.e) mean += e / count;
  for (std::size_t k = 0; k < axis.e.size(); ++k) {
    shown.own += axis.own[k] / count;
    shown.spread += (axis.e[k] - mean) * (axis.e[k] - mean) / count;
  }
  return shown;
}

// Of one axis that is known badly nothing is to be told of the others.
struct Sizes {
  double least = 0.0;
  int count = 0;  // powers of two of `least` from kSizeLeast on
  [[nodiscard]] double Of(int j) const { return least * std::exp2(kSizeLeast + j); }
};
Sizes SizesFor(const std::vector<Series>& axes) {
  Sizes sizes{std::numeric_limits<double>::infinity(), 0};
  double most = 0.0;
  for (const Series& axis : axes) {
    const Shown shown = ShownBy(axis);
    sizes.least = std::min(sizes.least, shown.own + shown.spread);
    most = std::max(most, shown.spread - shown.own);
  }
  if (!(sizes.least > 0) || !std::isfinite(sizes.least)) return {};
  const double ratio = std::max(1.0, most / sizes.least);
  sizes.count = std::min(kSizesMax, 1 - kSizeLeast + static_cast<int>(std::lround(std::log2(kWalkMost * ratio))));
  return sizes;
}

// Of one size of the walk, over all sizes of v: log of the sum of the likelihoods.
double LogEvidence(const std::vector<Series>& axes, double walk, const Sizes& noises) {
  std::vector<double> logs;
  for (int j = -1; j < noises.count; ++j) {
    double log = 0.0;
    for (const Series& axis : axes) log += LogLikelihood(axis, walk, j < 0 ? 0.0 : noises.Of(j));
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

// Of a place that stays, and of sizes of a walk: by their log likelihoods.
Variance MeanOf(double of_stay, const std::vector<double>& logs, const Sizes& sizes) {
  const double most = std::max(of_stay, *std::max_element(logs.begin(), logs.end()));
  double weights = static_cast<double>(sizes.count) * std::exp(of_stay - most), sum = 0.0, squares = 0.0;
  for (int j = 0; j < sizes.count; ++j) {
    const double weight = std::exp(logs[static_cast<std::size_t>(j)] - most), size = std::exp2(kSizeLeast + j);
    weights += weight, sum += weight * size, squares += weight * size * size;
  }
  const double mean = sum / weights, variance = squares / weights - mean * mean;
  if (!std::isfinite(mean)) return {};
  return {sizes.least * mean, variance > 0 ? 2 * mean * mean / variance : std::numeric_limits<double>::max()};
}

Variance WalkAlong(const std::vector<VisitResidual>& visits, int part) {
  const std::vector<Series> axes = AxesOf(visits, part);
  const double days = visits.back().age_days - visits.front().age_days;
  const Sizes sizes = SizesFor(axes);
  if (!(days > 0) || sizes.count == 0) return {};
  std::vector<double> logs;
  for (int j = 0; j < sizes.count; ++j) logs.push_back(LogEvidence(axes, sizes.Of(j) / days, sizes));
  const Variance over_all = MeanOf(LogEvidence(axes, 0.0, sizes), logs, sizes);
  return {over_all.mean / days, over_all.dof};
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

WalkResiduals ResidualsAboutWalk(std::vector<VisitResidual> visits, const VisitVariance& per_day,
                                 const VisitVariance& scatter) {
  WalkResiduals about{std::move(visits), {}};
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
