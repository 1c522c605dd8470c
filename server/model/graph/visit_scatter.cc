#include "server/model/graph/visit_scatter.h"

#include <cmath>

#include "server/math/statistics.h"

namespace rigcal {
namespace {

constexpr double kStandsOut = 0.05;  // odds that a robot like its pool shows so much

// A pool is as sure as the sum of what it tells and of what its visits err by.
double DofAsSeenBy(const ScatterOfAxes& own, const ScatterOfAxes& pooled) {
  const double here = std::max(0.0, pooled.between) + own.own, there = pooled.Shown();
  if (!(there > 0) || here >= there) return pooled.dof;
  return pooled.dof * std::pow(here / there, 2);
}

// The sensors' geometric mean, as seen by visits that err as those of `own`.
double MeanBetween(const ScatterOfAxes& own, const std::vector<ScatterOfAxes>& of_robot) {
  double logs = 0.0;
  for (const ScatterOfAxes& sensor : of_robot) logs += std::log(std::max(0.0, sensor.between) + own.own);
  return std::exp(logs / static_cast<double>(of_robot.size())) - own.own;
}

// Each axis by itself, but for the few numbers that the robot's axes on the whole are worth.
ScatterTaken TakenAlone(const ScatterOfAxes& own, std::vector<ScatterOfAxes> of_robot) {
  if (!(own.dof > 0)) return {std::max(0.0, own.between), 0.0, false};
  std::erase_if(of_robot, [](const ScatterOfAxes& sensor) { return !(sensor.dof > 0); });
  if (of_robot.empty()) of_robot.push_back(own);
  const double nu = own.dof / 3, few = 2 - 1 / static_cast<double>(of_robot.size());
  if (!own.TellsAxes()) return {std::max(0.0, own.between), nu + few, false};
  const double on_the_whole = MeanBetween(own, of_robot);
  ScatterTaken taken{0.0, nu + few, false};
  ThreeAxes variance{};
  for (std::size_t axis = 0; axis < variance.size(); ++axis) {
    const double shown = own.ratio[axis] * own.Shown() - own.own;
    variance[axis] = std::max(0.0, (nu * shown + few * on_the_whole) / taken.dof);
    taken.variance += variance[axis] / 3;
  }
  for (std::size_t axis = 0; axis < variance.size() && taken.variance > 0; ++axis)
    taken.share[axis] = variance[axis] / taken.variance;
  return taken;
}

// Of means of the axes.
ScatterTaken MeanTaken(const ScatterOfAxes& own, const std::optional<ScatterOfAxes>& pooled) {
  const ScatterTaken alone{std::max(0.0, own.between), own.dof, false};
  if (!pooled) return alone;
  const double pool_dof = DofAsSeenBy(own, *pooled), expected = std::max(0.0, pooled->between) + own.own;
  if (!(pool_dof > 0) || !(expected > 0)) return alone;
  if (own.dof > 0 && FisherTail(own.Shown() / expected, own.dof, pool_dof) < kStandsOut) return alone;
  const double dof = own.dof + pool_dof;
  return {std::max(0.0, (own.dof * own.between + pool_dof * std::max(0.0, pooled->between)) / dof), dof, true};
}

}  // namespace

ScatterOfAxes InShares(const ThreeAxes& share, double between, const ScatterOfAxes& scatter) {
  if (!scatter.TellsAxes()) return scatter;
  double sum = 0.0, weights = 0.0, most = 0.0;
  for (std::size_t axis = 0; axis < share.size(); ++axis) {
    const double expected = std::max(0.0, between) * share[axis] + scatter.own;
    if (!(expected > 0)) continue;
    sum += share[axis] / (expected * expected) * (scatter.ratio[axis] * scatter.Shown() - scatter.own);
    const double weight = std::pow(share[axis] / expected, 2);
    weights += weight;
    most = std::max(most, weight);
  }
  if (!(weights > 0)) return scatter;
  ScatterOfAxes mean = scatter;
  mean.between = std::max(-scatter.own, sum / weights);
  mean.dof = scatter.dof / 3 * weights / most;
  return mean;
}

ScatterTaken TakenScatter(const ScatterOfAxes& own, const std::optional<ScatterOfAxes>& pooled,
                          const std::vector<ScatterOfAxes>& of_robot) {
  if (!pooled || !pooled->TellsAxes()) {
    const ScatterTaken mean = MeanTaken(own, pooled);
    return mean.by_pool ? mean : TakenAlone(own, of_robot);
  }
  ScatterTaken taken = MeanTaken(InShares(pooled->ratio, pooled->dof > 0 ? pooled->between : own.between, own), pooled);
  if (taken.dof > 0) taken.share = pooled->ratio;  // else there is nothing of which it is a share
  return taken;
}

Vector6d AlongAxes(const ScatterTaken& translation, const ScatterTaken& rotation) {
  Vector6d along;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    along[static_cast<Eigen::Index>(axis)] = translation.variance * translation.share[axis];
    along[static_cast<Eigen::Index>(axis) + 3] = rotation.variance * rotation.share[axis];
  }
  return along;
}

}  // namespace rigcal
