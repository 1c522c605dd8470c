#include "server/model/as_found.h"

#include <algorithm>
#include <cmath>

#include "server/base/text.h"

namespace rigcal {
namespace {

double LargestSmallest(const std::vector<SensorFound>& sensors, int first_axis) {
  double largest = 0.0;
  for (const SensorFound& sensor : sensors)
    for (int axis = first_axis; axis < first_axis + 3; ++axis)
      if (sensor.IsMeasured(axis)) largest = std::max(largest, sensor.smallest(axis));
  return largest;
}

}  // namespace

std::string NameOf(FoundState state) {
  switch (state) {
    case FoundState::kUnchanged:
      return "unchanged";
    case FoundState::kDrifted:
      return "drifted";
    case FoundState::kNotMeasured:
      return "not_measured";
    case FoundState::kMovedOnPurpose:
      return "moved_on_purpose";
    case FoundState::kNew:
      return "new";
  }
  return "not_measured";
}

Result<FoundState> FoundStateOf(const std::string& name) {
  for (const FoundState state : {FoundState::kUnchanged, FoundState::kDrifted, FoundState::kNotMeasured,
                                 FoundState::kMovedOnPurpose, FoundState::kNew})
    if (NameOf(state) == name) return state;
  return Fail(ErrorCode::kInvalidInput, "the state " + Quoted(name) + " of a sensor as found is not known",
              "Use unchanged, drifted, not_measured, moved_on_purpose or new.");
}

bool SensorFound::IsMeasured(int axis) const {
  const FoundState of_axis = axes[static_cast<std::size_t>(axis)];
  return of_axis == FoundState::kUnchanged || of_axis == FoundState::kDrifted;
}

double SensorFound::InSigmas() const {
  double largest = 0.0;
  for (int axis = 0; axis < 6; ++axis)
    if (IsMeasured(axis)) largest = std::max(largest, std::abs(change(axis)) / sigma(axis));
  return largest;
}

FoundState AsFound::State() const {
  FoundState state = FoundState::kNotMeasured;
  for (const SensorFound& sensor : sensors) {
    if (sensor.state == FoundState::kDrifted) return FoundState::kDrifted;
    if (sensor.state == FoundState::kUnchanged) state = FoundState::kUnchanged;
  }
  return state;
}

double AsFound::Smallest_m() const { return LargestSmallest(sensors, tangent::kTranslation); }
double AsFound::Smallest_rad() const { return LargestSmallest(sensors, tangent::kRotation); }

AsFoundSummary SummaryOf(const AsFound& found) {
  AsFoundSummary summary{found.session, found.State(), {}};
  for (const SensorFound& sensor : found.sensors)
    if (sensor.state == FoundState::kDrifted) summary.drifted.push_back(sensor.sensor);
  return summary;
}

}  // namespace rigcal
