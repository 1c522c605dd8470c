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

}  // namespace

ScatterTaken TakenScatter(const ScatterOfAxes& own, const std::optional<ScatterOfAxes>& pooled) {
  const ScatterTaken alone{std::max(0.0, own.between), own.dof, false};
  if (!pooled) return alone;
  const double pool_dof = DofAsSeenBy(own, *pooled), expected = std::max(0.0, pooled->between) + own.own;
  if (!(pool_dof > 0) || !(expected > 0)) return alone;
  if (own.dof > 0 && FisherTail(own.Shown() / expected, own.dof, pool_dof) < kStandsOut) return alone;
  const double dof = own.dof + pool_dof;
  return {std::max(0.0, (own.dof * own.between + pool_dof * std::max(0.0, pooled->between)) / dof), dof, true};
}

}  // namespace rigcal
