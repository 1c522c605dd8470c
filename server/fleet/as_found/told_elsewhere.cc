#include <algorithm>

#include "server/fleet/as_found/as_found.h"

namespace rigcal::fleet {
namespace {

std::optional<Vector6d> LargestOf(const SensorId& sensor, const std::vector<SensorMovedBetween>& elsewhere) {
  std::optional<Vector6d> largest;
  const auto is_larger = [&](const Vector6d& step) {
    return !largest || TimesLimit(step, kDefaultTolerance) > TimesLimit(*largest, kDefaultTolerance);
  };
  for (const SensorMovedBetween& one : elsewhere)
    if (one.sensor == sensor && is_larger(one.step)) largest = one.step;
  return largest;
}

void SetNotToldApart(SensorFound& sensor) {
  sensor.state = FoundState::kNotToldApart;
  std::replace(sensor.axes.begin(), sensor.axes.end(), FoundState::kUnchanged, FoundState::kNotToldApart);
}

}  // namespace

void MarkElsewhere(const std::vector<SensorMovedBetween>& elsewhere, AsFound& found) {
  const std::optional<Vector6d> of_frame = LargestOf(found.relative_to, elsewhere);
  for (SensorFound& sensor : found.sensors) {
    if (sensor.state != FoundState::kUnchanged) continue;
    sensor.elsewhere = LargestOf(sensor.sensor, elsewhere);
    if (!sensor.elsewhere && !of_frame) continue;
    SetNotToldApart(sensor);
    if (of_frame) found.elsewhere = of_frame;
  }
}

}  // namespace rigcal::fleet
