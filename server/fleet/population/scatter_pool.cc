#include "server/fleet/population/scatter_pool.h"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>

#include "server/math/log_variance.h"
#include "server/math/statistics.h"
#include "server/model/robots/population.h"

namespace rigcal::fleet {
namespace {

constexpr double kSpreadBound = 0.1;  // odds with which the spread of robots is taken as too small
constexpr double kNoStranger = 0.3;   // expected number of robots that show as much as the one that shows most
constexpr double kLeastShown = 1e-6;  // of what visits err by: less is zero by chance
constexpr double kLeastRatio = 1e-3;  // less is zero by chance
constexpr double kThreeVisits = 6.0;  // degrees of freedom of their three axes
constexpr int kHalvings = 40;

struct Shown {
  double variance = 0.0, dof = 0.0, z = 0.0;  // z: log variance without its bias
};

std::vector<Shown> ShownBy(const std::vector<ScatterOfAxes>& robots) {
  std::vector<Shown> all;
  for (const ScatterOfAxes& one : robots) {
    const double variance = std::max(one.Shown(), kLeastShown * one.own);
    if (one.dof > 0 && variance > 0) all.push_back({variance, one.dof, std::log(variance) - LogVarianceBias(one.dof)});
  }
  return all;
}

// How unlike the axes are, and how surely: of mean one (zeros: not told), and the variance of its logs by chance.
struct AxesTold {
  ThreeAxes ratio = {};
  double by_chance = 0.0;
};

// Of logs that chance makes differ by a variance of `by_chance`.
AxesTold Shrunk(const Eigen::Array3d& log_ratio, double by_chance) {
  const Eigen::Array3d apart = log_ratio - log_ratio.mean();
  const double variance = apart.square().sum() / 2;
  const Eigen::Array3d ratio = (apart * (variance > by_chance ? 1 - by_chance / variance : 0.0)).exp();
  const Eigen::Array3d of_mean_one = ratio / ratio.mean();
  return {{of_mean_one[0], of_mean_one[1], of_mean_one[2]}, by_chance};
}

// Not told where fewer than kPopulationMin of them tell their axes.
AxesTold AxesOf(const std::vector<ScatterOfAxes>& robots) {
  Eigen::Array3d sum = Eigen::Array3d::Zero();
  double weights = 0.0;
  std::size_t tellers = 0;
  for (const ScatterOfAxes& one : robots) {
    if (!one.TellsAxes() || !(one.dof > 0)) continue;
    const double weight = 1 / LogVarianceSpread(one.dof / 3);
    sum += weight * Eigen::Array3d(one.ratio[0], one.ratio[1], one.ratio[2]).max(kLeastRatio).log();
    weights += weight;
    ++tellers;
  }
  return tellers < kPopulationMin ? AxesTold{} : Shrunk(sum / weights, 1 / weights);
}

struct LogMoments {
  double mean = 0.0, spread = 0.0;    // of z
  double by_chance = 0.0, dof = 0.0;  // mean trigamma; sum
};
LogMoments LogMomentsOf(const std::vector<Shown>& all) {
  const auto count = static_cast<double>(all.size());
  LogMoments moments;
  for (const Shown& one : all) {
    moments.mean += one.z / count;
    moments.by_chance += LogVarianceSpread(one.dof) / count;
    moments.dof += one.dof;
  }
  for (const Shown& one : all) moments.spread += std::pow(one.z - moments.mean, 2) / (count - 1);
  return moments;
}

double CentreOf(const LogMoments& moments, double dof) { return std::exp(moments.mean + LogVarianceBias(dof)); }

double NoStrangerDof(const std::vector<Shown>& all, const LogMoments& moments, double dof) {
  const Shown& most =
      *std::max_element(all.begin(), all.end(), [](const Shown& x, const Shown& y) { return x.z < y.z; });
  const auto is_stranger = [&](double at) {
    return FisherTail(most.variance / CentreOf(moments, at), most.dof, at) <
           kNoStranger / static_cast<double>(all.size());
  };
  if (!is_stranger(dof)) return dof;
  double low = 1.0, high = dof;  // below kPoolDofMin it does not matter
  for (int i = 0; i < kHalvings; ++i) {
    const double middle = 0.5 * (low + high);
    (is_stranger(middle) ? high : low) = middle;
  }
  return low;
}

double DofOfPool(const std::vector<Shown>& all, const LogMoments& moments) {
  const auto freedom = static_cast<double>(all.size()) - 1;
  const double spread = moments.spread * freedom / ChiSquareQuantile(kSpreadBound, freedom) - moments.by_chance;
  return NoStrangerDof(all, moments, std::min({DofOfLogVarianceSpread(spread), moments.dof, kPoolDofMax}));
}

// Of mean one, from ratios of what is shown; alike where nothing scatters.
ThreeAxes SharesOf(const ThreeAxes& ratio, double between, double own) {
  const Eigen::Array3d along = (between + own) * Eigen::Array3d(ratio[0], ratio[1], ratio[2]) - own;
  const Eigen::Array3d least = along.max(kLeastRatio * between), share = least / least.mean();
  return between > 0 ? ThreeAxes{share[0], share[1], share[2]} : ThreeAxes{1.0, 1.0, 1.0};
}

// Puts the shares into `pool`, whose `own` is there, and takes the robots by them. What chance makes of their logs.
double TakeShares(std::vector<ScatterOfAxes>& robots, ScatterOfAxes& pool) {
  const AxesTold axes = AxesOf(robots);
  if (!(axes.ratio[0] > 0)) return 0.0;
  double between = 0.0;
  for (const ScatterOfAxes& one : robots) between += one.between / static_cast<double>(robots.size());
  pool.ratio = SharesOf(axes.ratio, std::max(0.0, between), pool.own);
  for (ScatterOfAxes& one : robots) one = InShares(pool.ratio, between, one);
  return axes.by_chance;
}

std::optional<ScatterOfAxes> PoolOf(std::vector<ScatterOfAxes> robots) {
  ScatterOfAxes pool;
  for (const ScatterOfAxes& one : robots) pool.own += one.own / static_cast<double>(robots.size());
  const double by_chance = TakeShares(robots, pool);
  const std::vector<Shown> all = ShownBy(robots);
  if (all.size() < kPopulationMin) return std::nullopt;
  const LogMoments moments = LogMomentsOf(all);
  const double dof = DofOfLogVarianceSpread(LogVarianceSpread(DofOfPool(all, moments)) + by_chance);
  const bool tells_axes = pool.TellsAxes() && DofOfLogVarianceSpread(by_chance) >= kAxesDofMin;
  if (dof < kPoolDofMin) return tells_axes ? std::optional(pool) : std::nullopt;
  pool.dof = dof;
  pool.between = std::max(0.0, CentreOf(moments, dof) - pool.own);
  return pool;
}

}  // namespace

PooledScatter PoolScatter(const std::vector<RobotScatter>& robots) {
  std::map<SensorId, std::vector<const VisitScatter*>> by_sensor;
  for (const RobotScatter& robot : robots)
    for (const auto& [sensor, scatter] : robot)
      if (scatter.translation.dof >= kThreeVisits && scatter.rotation.dof >= kThreeVisits)
        by_sensor[sensor].push_back(&scatter);
  PooledScatter pooled;
  for (const auto& [sensor, tellers] : by_sensor) {
    std::vector<ScatterOfAxes> translations, rotations;
    for (const VisitScatter* one : tellers)
      translations.push_back(one->translation), rotations.push_back(one->rotation);
    const auto translation = PoolOf(translations), rotation = PoolOf(rotations);
    if (translation && rotation) pooled[sensor] = {*translation, *rotation, static_cast<int>(tellers.size())};
  }
  return pooled;
}

}  // namespace rigcal::fleet
