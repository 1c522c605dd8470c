#include "server/fleet/as_found/smallest_change.h"

#include <algorithm>
#include <cmath>

#include "server/math/statistics.h"

namespace rigcal::fleet {
namespace {

using Eigen::Index;

constexpr double kDofAsKnown = 1e4;

bool IsKnown(double dof) { return dof <= 0 || dof > kDofAsKnown; }

// What a change errs by.
struct ErrorOfChange {
  double variance = 0.0, dof = 0.0;
};

// Of rows that show what was assumed: how many, and over how much of it beyond all else.
struct ShownOfAssumed {
  int rows = 0;
  double beyond = 0.0, assumed = 0.0;
  [[nodiscard]] double Ratio() const { return std::max(0.0, beyond) / assumed; }
};

// Shifts or turns, as the row is.
ShownOfAssumed ShownBeside(const ChangeSeen& seen, Index row, const std::vector<SensorId>& still) {
  ShownOfAssumed shown;
  for (Index other = 0; other < seen.change.size(); ++other) {
    const SensorId& sensor = seen.sensors[static_cast<std::size_t>(other / 6)];
    if (other / 6 == row / 6 || other % 6 / 3 != row % 6 / 3 || !(seen.assumed(other) > 0)) continue;
    if (!seen.IsMeasured(other) || std::find(still.begin(), still.end(), sensor) == still.end()) continue;
    ++shown.rows;
    shown.beyond += seen.change(other) * seen.change(other) - (seen.covariance(other, other) - seen.assumed(other));
    shown.assumed += seen.assumed(other);
  }
  return shown;
}

ErrorOfChange ErrorOf(const ChangeSeen& seen, Index row, const std::vector<SensorId>& still) {
  const ErrorOfChange told{seen.covariance(row, row), seen.dof[static_cast<std::size_t>(row)]};
  if (!(seen.assumed(row) > 0)) return told;
  const ShownOfAssumed shown = ShownBeside(seen, row, still);
  if (shown.rows == 0) return told;
  const double dof = IsKnown(told.dof) ? shown.rows : std::min<double>(shown.rows, told.dof);
  return {told.variance + (shown.Ratio() - 1) * seen.assumed(row), dof};
}

}  // namespace

double LimitInSigmas(double alpha_of_axis, double dof) {
  return std::sqrt(IsKnown(dof) ? ChiSquareQuantile(1 - alpha_of_axis, 1) : FisherQuantile(alpha_of_axis, 1, dof));
}

double BeyondLimitInSigmas(double dof) {
  return IsKnown(dof) ? std::sqrt(ChiSquareQuantile(2 * kAsFoundPower - 1, 1)) : StudentQuantile(kAsFoundPower, dof);
}

double SmallestChange(const ChangeSeen& seen, Index row, const std::vector<SensorId>& still, double alpha_of_axis) {
  const double limit = LimitInSigmas(alpha_of_axis, seen.dof[static_cast<std::size_t>(row)]) * seen.Sigma(row);
  const ErrorOfChange error = ErrorOf(seen, row, still);
  return limit + BeyondLimitInSigmas(error.dof) * std::sqrt(error.variance);
}

}  // namespace rigcal::fleet
