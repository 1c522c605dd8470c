#include "server/model/sessions/as_found.h"

#include <algorithm>
#include <cmath>

#include "server/base/text.h"

namespace rigcal {
namespace {

bool IsOfATest(FoundState state) {
  return state == FoundState::kUnchanged || state == FoundState::kDrifted || state == FoundState::kNotToldApart;
}

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
    case FoundState::kNotToldApart:
      return "not_told_apart";
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
  for (const FoundState state : {FoundState::kUnchanged, FoundState::kDrifted, FoundState::kNotToldApart,
                                 FoundState::kNotMeasured, FoundState::kMovedOnPurpose, FoundState::kNew})
    if (NameOf(state) == name) return state;
  return Fail(ErrorCode::kInvalidInput, "the state " + Quoted(name) + " of a sensor as found is not known",
              "Use unchanged, drifted, not_told_apart, not_measured, moved_on_purpose or new.");
}

bool IsTested(const SensorFound& sensor) { return IsOfATest(sensor.state); }

bool IsMeasured(const SensorFound& sensor, int axis) { return IsOfATest(sensor.axes[static_cast<std::size_t>(axis)]); }

bool CouldTell(const SensorFound& sensor) {
  for (int axis = 0; axis < 6; ++axis)
    if (IsMeasured(sensor, axis) && !std::isfinite(sensor.smallest(axis))) return false;
  return true;
}

std::string WordFor(const SensorFound& sensor) {
  if (sensor.state == FoundState::kUnchanged && !CouldTell(sensor)) return "cannot tell";
  if (sensor.state == FoundState::kNotToldApart) return "not told apart from scatter";
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
  bool any_unchanged = false, all_told_apart = true;
  for (const SensorFound& sensor : found.sensors) {
    if (sensor.state == FoundState::kDrifted) return FoundState::kDrifted;
    any_unchanged |= sensor.state == FoundState::kUnchanged && CouldTell(sensor);
    all_told_apart &= sensor.state != FoundState::kNotToldApart;
  }
  return any_unchanged && all_told_apart ? FoundState::kUnchanged : FoundState::kNotMeasured;
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
