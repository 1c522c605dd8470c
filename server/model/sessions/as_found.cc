#include "server/model/sessions/as_found.h"

#include <algorithm>
#include <cmath>

#include "server/base/text.h"

namespace rigcal {
namespace {

double LargestSmallest(const std::vector<SensorFound>& sensors, int first_axis) {
  double largest = 0.0;
  for (const SensorFound& sensor : sensors)
    for (int axis = first_axis; axis < first_axis + 3; ++axis)
      if (IsMeasured(sensor, axis)) largest = std::max(largest, sensor.smallest(axis));
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

bool IsMeasured(const SensorFound& sensor, int axis) {
  const FoundState of_axis = sensor.axes[static_cast<std::size_t>(axis)];
  return of_axis == FoundState::kUnchanged || of_axis == FoundState::kDrifted;
}

bool CouldTell(const SensorFound& sensor) {
  for (int axis = 0; axis < 6; ++axis)
    if (IsMeasured(sensor, axis) && !std::isfinite(sensor.smallest(axis))) return false;
  return true;
}

std::string WordFor(const SensorFound& sensor) {
  if (sensor.state == FoundState::kUnchanged && !CouldTell(sensor)) return "cannot tell";
  std::string word = NameOf(sensor.state);
  std::replace(word.begin(), word.end(), '_', ' ');
  return word;
}

double InSigmas(const SensorFound& sensor) {
  double largest = 0.0;
  for (int axis = 0; axis < 6; ++axis)
    if (IsMeasured(sensor, axis)) largest = std::max(largest, std::abs(sensor.change(axis)) / sensor.sigma(axis));
  return largest;
}

FoundState StateOf(const AsFound& found) {
  FoundState state = FoundState::kNotMeasured;
  for (const SensorFound& sensor : found.sensors) {
    if (sensor.state == FoundState::kDrifted) return FoundState::kDrifted;
    if (sensor.state == FoundState::kUnchanged && CouldTell(sensor)) state = FoundState::kUnchanged;
  }
  return state;
}

double SmallestSeen_m(const AsFound& found) { return LargestSmallest(found.sensors, tangent::kTranslation); }
double SmallestSeen_rad(const AsFound& found) { return LargestSmallest(found.sensors, tangent::kRotation); }

AsFoundSummary SummaryOf(const AsFound& found) {
  AsFoundSummary summary{found.session, StateOf(found), {}};
  for (const SensorFound& sensor : found.sensors)
    if (sensor.state == FoundState::kDrifted) summary.drifted.push_back(sensor.sensor);
  return summary;
}

}  // namespace rigcal
