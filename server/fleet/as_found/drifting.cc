#include <algorithm>
#include <cmath>

#include "server/fleet/as_found/as_found.h"
#include "server/fleet/as_found/smallest_change.h"
#include "server/fleet/wording.h"

namespace rigcal::fleet {
namespace {

// A line through three visits leaves one number for what they scatter by: that is no test.
constexpr int kVisitsForDrifting = 4;
constexpr int kNumbersOfALine = 2;

// Sigmas from which on a rate is more than chance, and that are told with kAsFoundPower.
struct RateLimit {
  double told = 0.0, smallest = 0.0;
};
RateLimit LimitOfRates(const DriftRate& rate, const AsFound& found) {
  const double dof = rate.visits - kNumbersOfALine;
  const double told = LimitInSigmas(kAlphaOfRates * found.alpha / std::max(1, found.tests), dof);
  return {told, told + BeyondLimitInSigmas(dof)};
}

bool IsAxisDrifting(const DriftRate& rate, int axis, const RateLimit& limit, double least) {
  const double size = std::abs(rate.per_30_days(axis));
  return size > limit.told * rate.sigma_per_30_days(axis) && size > least;
}

// Of the three axes from `first` on that were measured.
double LargestSigma(const SensorFound& sensor, int first) {
  double largest = 0.0;
  for (int axis = first; axis < first + 3; ++axis)
    if (IsMeasured(sensor, axis)) largest = std::max(largest, sensor.rate->sigma_per_30_days(axis));
  return largest;
}

// "1.2 mm", "0.3 deg" or both: of halves that do not drift nothing.
std::string RateText(const Vector6d& per_30_days) {
  const double m = per_30_days.head<3>().norm(), rad = per_30_days.tail<3>().norm();
  const std::string shift = Number(1e3 * m, "mm"), turn = Number(kDegreesPerRadian * rad, "deg");
  return !(rad > 0) ? shift : !(m > 0) ? turn : shift + ", " + turn;
}

}  // namespace

std::optional<Drifting> DriftingOf(const SensorFound& sensor, const AsFound& found,
                                   const PoseLimit& least_per_30_days) {
  if (!sensor.rate || sensor.rate->visits < kVisitsForDrifting || !found.why_not.empty()) return std::nullopt;
  const DriftRate& rate = *sensor.rate;
  const RateLimit limit = LimitOfRates(rate, found);
  Drifting drifting;
  for (int axis = 0; axis < 6; ++axis)
    if (IsMeasured(sensor, axis) &&
        IsAxisDrifting(rate, axis, limit, axis < tangent::kRotation ? least_per_30_days.m : least_per_30_days.rad)) {
      drifting.per_30_days(axis) = rate.per_30_days(axis);
      drifting.sigmas = std::max(drifting.sigmas, std::abs(rate.per_30_days(axis)) / rate.sigma_per_30_days(axis));
    }
  if (!(drifting.sigmas > 0)) return std::nullopt;
  drifting.smallest = {std::max(least_per_30_days.m, limit.smallest * LargestSigma(sensor, tangent::kTranslation)),
                       std::max(least_per_30_days.rad, limit.smallest * LargestSigma(sensor, tangent::kRotation))};
  return drifting;
}

std::string DriftingText(const SensorFound& sensor, const Drifting& drifting) {
  return sensor.sensor.str() + " drifts by " + RateText(drifting.per_30_days) + " in 30 days (" +
         Number(drifting.sigmas, "sigma") + ", " + std::to_string(sensor.rate->visits) + " visits since " +
         DayText(sensor.rate->first) + "; the smallest drift that these visits could have told is " +
         TwoDigits(1e3 * drifting.smallest.m, "mm") + ", " +
         TwoDigits(kDegreesPerRadian * drifting.smallest.rad, "deg") + " in 30 days)";
}

}  // namespace rigcal::fleet
