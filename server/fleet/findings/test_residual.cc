#include <algorithm>
#include <cmath>

#include "server/fleet/assess.h"
#include "server/math/statistics.h"
#include "server/model/edges/captures_wanted.h"

namespace rigcal::fleet {
namespace {
constexpr double kDofMax = 1e6, kDofRounding = 1e-6;
}  // namespace

EdgeTest TestResidual(const Edge& edge, const EdgeResidual& residual, std::size_t edge_count, const Policy& policy) {
  EdgeTest test;
  const int rank = residual.by_jackknife ? residual.rank : edge.uncertainty.rank;
  if (!residual.in_solution || edge.state != EdgeState::kGood || rank < 1) return test;
  test.statistic = residual.by_jackknife ? residual.t_squared : residual.weighted;
  const double odds = (1.0 - policy.residual_probability) / static_cast<double>(std::max<std::size_t>(edge_count, 1));
  const double probability = 1.0 - odds;
  const int dof =
      residual.by_jackknife ? static_cast<int>(std::min(residual.dof, kDofMax) + kDofRounding) : edge.uncertainty.dof;
  const double limit = dof > 0 ? HotellingLimit(dof + 1, rank, probability) : ChiSquareQuantile(probability, rank);
  test.limit = std::isfinite(limit) && limit <= kResidualLimitMax ? limit : 0.0;
  return test;
}

}  // namespace rigcal::fleet
