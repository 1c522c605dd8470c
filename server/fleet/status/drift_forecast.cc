#include "server/fleet/status/drift_forecast.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numbers>
#include <set>

namespace rigcal::fleet {
namespace {

using Eigen::Index;

// Time is in steps' mean time here: in any other unit it is the unit that chooses the law. Values of s, in tolerances
// per root of it (random walk) or per it (linear), evenly in their logarithm.
constexpr int kScales = 72;
constexpr double kScaleMin = 1e-5, kScaleMax = 10.0;
constexpr double kSameOdds = 0.01;
using PerScale = std::array<double, kScales>;

double DriftScale(int scale, double tolerance) {
  return tolerance * kScaleMin * std::pow(kScaleMax / kScaleMin, scale / double{kScales - 1});
}

// One half of the steps: their shifts, or their turns.
struct ForecastHalf {
  Index first = 0;
  double tolerance = 0.0;
};

// What a robot's visits tell of the rate of one axis: precision, and precision times rate.
struct RateInformation {
  double A = 0.0, B = 0.0;
};
using RobotRates = std::array<RateInformation, 3>;
using RatesByRobot = std::map<RobotId, RobotRates>;

bool IsUsableStep(const DriftStep& step) {
  return step.days > 0 && std::isfinite(step.days) && step.change.allFinite() && step.sigma.allFinite() &&
         step.sigma.maxCoeff() > 0;
}

template <typename Take>  // (step, axis of the half, time, change, variance)
void ForEachAxis(const std::vector<DriftStep>& steps, const ForecastHalf& half, const Take& take) {
  for (const DriftStep& step : steps)
    for (Index axis = 0; axis < 3; ++axis)
      if (const double sigma = step.sigma(half.first + axis); sigma > 0)
        take(step, static_cast<std::size_t>(axis), step.days, step.change(half.first + axis), sigma * sigma);
}

PerScale RandomWalkLikelihood(const std::vector<DriftStep>& steps, const ForecastHalf& half) {
  PerScale log_likelihood{};
  for (int j = 0; j < kScales; ++j) {
    const double s2 = std::pow(DriftScale(j, half.tolerance), 2);
    double& sum = log_likelihood[static_cast<std::size_t>(j)];
    ForEachAxis(steps, half, [&](const DriftStep&, std::size_t, double time, double change, double variance) {
      const double whole = variance + s2 * time;
      sum -= 0.5 * (std::log(whole) + change * change / whole);
    });
  }
  return log_likelihood;
}

RatesByRobot RatesOf(const std::vector<DriftStep>& steps, const ForecastHalf& half) {
  RatesByRobot rates;
  ForEachAxis(steps, half, [&](const DriftStep& step, std::size_t axis, double time, double change, double variance) {
    RateInformation& one = rates[step.robot][axis];
    one.A += time * time / variance;
    one.B += time * change / variance;
  });
  return rates;
}

// A robot's rate integrated out: its visits are normal with diagonal plus s^2 t t^T (Sherman and Morrison 1950).
PerScale LinearLikelihood(const std::vector<DriftStep>& steps, const ForecastHalf& half, const RatesByRobot& rates) {
  double still = 0.0;  // nothing moves
  ForEachAxis(steps, half, [&](const DriftStep&, std::size_t, double, double change, double variance) {
    still -= 0.5 * (std::log(variance) + change * change / variance);
  });
  PerScale log_likelihood{};
  for (int j = 0; j < kScales; ++j) {
    const double s2 = std::pow(DriftScale(j, half.tolerance), 2);
    double sum = still;
    for (const auto& [robot, axes] : rates)
      for (const RateInformation& one : axes)
        sum -= 0.5 * (std::log1p(s2 * one.A) - s2 * one.B * one.B / (1 + s2 * one.A));
    log_likelihood[static_cast<std::size_t>(j)] = sum;
  }
  return log_likelihood;
}

double Best(const PerScale& log_likelihood) { return *std::max_element(log_likelihood.begin(), log_likelihood.end()); }

// Flat in s: the grid is one of its logarithm.
PerScale Weights(const PerScale& log_likelihood) {
  const double best = Best(log_likelihood);
  PerScale weights{};
  double sum = 0.0;
  for (int j = 0; j < kScales; ++j) {
    const auto at = static_cast<std::size_t>(j);
    weights[at] = std::exp(log_likelihood[at] - best) * DriftScale(j, 1.0);
    sum += weights[at];
  }
  for (double& weight : weights) weight /= sum;
  return weights;
}

// Where a sensor will be, of each scale: about `distance` away per unit of time, give or take `sigma` per that or its
// root.
struct Outlook {
  PerScale weight{}, distance{}, sigma{};
  DriftLaw law = DriftLaw::kRandomWalk;
  double tolerance = 0.0;

  [[nodiscard]] double OddsBeyond(double time) const {
    const double spread = law == DriftLaw::kLinear ? time : std::sqrt(time);
    double odds = 0.0;
    for (std::size_t j = 0; j < weight.size(); ++j)
      odds += weight[j] * BeyondBall(distance[j] * time, sigma[j] * spread, tolerance);
    return odds;
  }
};

Outlook RandomWalkOutlook(const PerScale& log_likelihood, const ForecastHalf& half) {
  Outlook outlook{Weights(log_likelihood), {}, {}, DriftLaw::kRandomWalk, half.tolerance};
  for (int j = 0; j < kScales; ++j) outlook.sigma[static_cast<std::size_t>(j)] = DriftScale(j, half.tolerance);
  return outlook;
}

// The robot's rate after its own visits; of axes that are known differently the least known stands for all.
Outlook LinearOutlook(const PerScale& log_likelihood, const ForecastHalf& half, const RobotRates& own) {
  Outlook outlook{Weights(log_likelihood), {}, {}, DriftLaw::kLinear, half.tolerance};
  for (int j = 0; j < kScales; ++j) {
    const double s2 = std::pow(DriftScale(j, half.tolerance), 2);
    double variance = 0.0, squares = 0.0;
    for (const RateInformation& one : own) {
      const double of_axis = s2 / (1 + s2 * one.A);
      variance = std::max(variance, of_axis);
      squares += std::pow(of_axis * one.B, 2);
    }
    outlook.sigma[static_cast<std::size_t>(j)] = std::sqrt(variance);
    outlook.distance[static_cast<std::size_t>(j)] = std::sqrt(squares);
  }
  return outlook;
}

// Of the steps, the scale integrated out, flat in how far a sensor goes in a step; but for what is the same of both
// laws.
double LogEvidence(const PerScale& log_likelihood) {
  const double best = Best(log_likelihood);
  double sum = 0.0;
  for (int j = 0; j < kScales; ++j)
    sum += std::exp(log_likelihood[static_cast<std::size_t>(j)] - best) * DriftScale(j, 1.0);
  return best + std::log(sum);
}

// Both halves by either law, and the odds of the second: visits that are all as far apart tell the laws hardly apart,
// and by these a sensor will have moved differently far sooner, or later, than that.
struct Outlooks {
  std::vector<Outlook> walking, linear;
  double linear_odds = 0.5;

  // Of laws that nothing tells apart the random walk, not what rounding makes of a half.
  [[nodiscard]] DriftLaw likelier() const {
    return linear_odds > 0.5 + kSameOdds ? DriftLaw::kLinear : DriftLaw::kRandomWalk;
  }
};
Outlooks OutlooksOf(const std::vector<DriftStep>& steps, const RobotId& robot, const PoseLimit& tolerance) {
  const std::array<ForecastHalf, 2> halves = {{{0, tolerance.m}, {3, tolerance.rad}}};
  Outlooks outlooks;
  double walk = 0.0, line = 0.0;
  for (const ForecastHalf& half : halves) {
    const RatesByRobot rates = RatesOf(steps, half);
    const PerScale by_walk = RandomWalkLikelihood(steps, half), by_line = LinearLikelihood(steps, half, rates);
    const auto own = rates.find(robot);
    walk += LogEvidence(by_walk);
    line += LogEvidence(by_line);
    outlooks.walking.push_back(RandomWalkOutlook(by_walk, half));
    outlooks.linear.push_back(LinearOutlook(by_line, half, own == rates.end() ? RobotRates{} : own->second));
  }
  outlooks.linear_odds = 1 / (1 + std::exp(walk - line));
  return outlooks;
}

double OddsOfEitherHalf(const std::vector<Outlook>& halves, double time) {
  double within = 1.0;
  for (const Outlook& one : halves) within *= 1 - one.OddsBeyond(time);
  return 1 - within;
}

double OddsBeyondAt(const Outlooks& outlooks, double time) {
  return (1 - outlooks.linear_odds) * OddsOfEitherHalf(outlooks.walking, time) +
         outlooks.linear_odds * OddsOfEitherHalf(outlooks.linear, time);
}

// The odds grow with the time.
double TimeUntilOdds(const Outlooks& outlooks, double time_max) {
  double early = 0.0, late = time_max;
  for (int i = 0; i < 48; ++i) {
    const double middle = 0.5 * (early + late);
    (OddsBeyondAt(outlooks, middle) < kForecastOdds ? early : late) = middle;
  }
  return early;
}

// The steps' geometric mean.
double MeanDays(const std::vector<DriftStep>& steps) {
  double sum = 0.0;
  for (const DriftStep& step : steps) sum += std::log(step.days);
  return std::exp(sum / static_cast<double>(steps.size()));
}

double Phi(double x) { return 0.5 * std::erfc(-x / std::numbers::sqrt2); }
double Bell(double x) { return std::exp(-0.5 * x * x) / std::sqrt(2 * std::numbers::pi); }

}  // namespace

double BeyondBall(double distance, double sigma, double radius) {
  if (!(sigma > 0)) return distance > radius ? 1.0 : 0.0;
  const double r = radius / sigma, d = distance / sigma;
  // Where both are close to each other the difference of the two bells is their slope.
  const double flow = d < 1e-6 ? 2 * r * Bell(r) : (Bell(r - d) - Bell(r + d)) / d;
  return std::clamp(1 - (Phi(r - d) - Phi(-r - d)) + flow, 0.0, 1.0);
}

std::optional<DriftForecast> ForecastDrift(const std::vector<DriftStep>& steps, const RobotId& robot,
                                           const PoseLimit& tolerance, double days_max) {
  std::vector<DriftStep> usable = steps;
  std::erase_if(usable, [](const DriftStep& step) { return !IsUsableStep(step); });
  if (static_cast<int>(usable.size()) < kForecastVisitsMin) return std::nullopt;
  if (!(tolerance.m > 0) || !(tolerance.rad > 0) || !(days_max > 0)) return std::nullopt;
  const double unit_days = MeanDays(usable);
  for (DriftStep& step : usable) step.days /= unit_days;
  const Outlooks outlooks = OutlooksOf(usable, robot, tolerance);
  if (!(OddsBeyondAt(outlooks, days_max / unit_days) > kForecastOdds)) return std::nullopt;
  std::set<RobotId> robots;
  for (const DriftStep& step : usable) robots.insert(step.robot);
  return DriftForecast{outlooks.likelier(), unit_days * TimeUntilOdds(outlooks, days_max / unit_days),
                       static_cast<int>(usable.size()), static_cast<int>(robots.size())};
}

}  // namespace rigcal::fleet
