#include <algorithm>
#include <cmath>

#include "server/fleet/as_found/as_found.h"
#include "server/fleet/wording.h"

namespace rigcal::fleet {
namespace {

constexpr int kVisitsForScatter = 5;
constexpr std::size_t kDriftsTold = 6;

std::vector<SensorId> InState(const AsFound& found, FoundState state) {
  std::vector<SensorId> sensors;
  for (const SensorFound& sensor : found.sensors)
    if (sensor.state == state) sensors.push_back(sensor.sensor);
  return sensors;
}

// "left unchanged", and of whom the session could not have told any change.
std::vector<std::string> UnchangedTexts(const AsFound& found) {
  std::vector<SensorId> unchanged, untold;
  for (const SensorFound& sensor : found.sensors)
    if (sensor.state == FoundState::kUnchanged) (CouldTell(sensor) ? unchanged : untold).push_back(sensor.sensor);
  std::vector<std::string> texts;
  if (!unchanged.empty()) texts.push_back(List(unchanged) + " unchanged");
  if (!untold.empty()) texts.push_back("whether " + List(untold) + " moved cannot be told");
  return texts;
}

// Of the half that matters more, as findings tell it.
std::string ElsewhereText(const Vector6d& step) { return OffFigure("", step, kDefaultTolerance).value; }

// "right not told apart from scatter: 7.75 mm"; of all that are seen from one that is not, once.
std::vector<std::string> NotToldApartTexts(const AsFound& found) {
  std::vector<std::string> texts;
  std::vector<SensorId> seen_from_it;
  for (const SensorFound& sensor : found.sensors) {
    if (sensor.state != FoundState::kNotToldApart) continue;
    if (sensor.elsewhere)
      texts.push_back(sensor.sensor.str() + " " + WordFor(sensor) + ": " + ElsewhereText(*sensor.elsewhere));
    else
      seen_from_it.push_back(sensor.sensor);
  }
  if (found.elsewhere)
    texts.push_back(found.relative_to.str() + " not told apart from scatter: " + ElsewhereText(*found.elsewhere));
  if (!seen_from_it.empty())
    texts.back() +=
        ", and so " + List(seen_from_it) + (seen_from_it.size() == 1 ? ", which is" : ", which are") + " seen from it";
  return texts;
}

// What was measured of it: the rest is zero.
std::string DriftText(const SensorFound& sensor) {
  const std::string moved = OffList(sensor.change) + " (" + Number(InSigmas(sensor), "sigma") + ")";
  if (sensor.or_else.empty()) return sensor.sensor.str() + " moved " + moved;
  return sensor.sensor.str() + " moved against " + sensor.or_else.str() + " " + moved + ", either of the two may have";
}

std::vector<std::string> DriftTexts(const AsFound& found) {
  std::vector<const SensorFound*> drifted;
  for (const SensorFound& sensor : found.sensors)
    if (sensor.state == FoundState::kDrifted) drifted.push_back(&sensor);
  std::stable_sort(drifted.begin(), drifted.end(),
                   [](const auto* x, const auto* y) { return InSigmas(*x) > InSigmas(*y); });
  std::vector<std::string> texts;
  for (std::size_t k = 0; k < std::min(drifted.size(), kDriftsTold); ++k) texts.push_back(DriftText(*drifted[k]));
  if (drifted.size() > kDriftsTold)
    texts.push_back(std::to_string(drifted.size() - kDriftsTold) + " more moved, by fewer sigmas");
  return texts;
}

std::string SmallestText(const AsFound& found) {
  const double m = SmallestSeen_m(found), rad = SmallestSeen_rad(found);
  if (!std::isfinite(m) || !std::isfinite(rad))
    return "too few captures to tell the smallest change it could have seen";
  return "smallest change this session could have seen: " + TwoDigits(1e3 * m, "mm") + ", " +
         TwoDigits(kDegreesPerRadian * rad, "deg");
}

std::string ScatterText(const AsFound& found) {
  const int visits = found.visits, robots = found.scatter_robots;
  if (visits >= kVisitsForScatter) return "";
  if (robots > 0)
    return "what visits scatter by is held against that of " + std::to_string(robots) +
           " other robots of its rig model";
  const std::string in_use = std::to_string(visits) + (visits == 1 ? " visit" : " visits") + " in use";
  if (visits < 2)
    return "with " + in_use +
           " the scatter from visit to visit is not known yet: the policy's moved_min is taken for it";
  return "with " + in_use + " the scatter from visit to visit is hardly known yet";
}

}  // namespace

std::string AsFoundText(const AsFound& found, const SessionTimes& captured_at) {
  std::string head = "As found (session of " + NameOfSession(found.session, captured_at);
  head += found.in_use > 0 ? ", against revision " + std::to_string(found.in_use) + "): " : "): ";
  if (!found.why_not.empty()) return head + "not tested. " + found.why_not;
  std::vector<std::string> parts = UnchangedTexts(found);
  const auto add_state = [&](FoundState state, const char* words) {
    if (const auto sensors = InState(found, state); !sensors.empty()) parts.push_back(List(sensors) + words);
  };
  for (std::string& text : NotToldApartTexts(found)) parts.push_back(std::move(text));
  for (std::string& text : DriftTexts(found)) parts.push_back(std::move(text));
  add_state(FoundState::kMovedOnPurpose, " moved on purpose");
  add_state(FoundState::kNew, " new");
  add_state(FoundState::kNotMeasured, " not measured");
  parts.push_back(SmallestText(found));
  if (const std::string scatter = ScatterText(found); !scatter.empty()) parts.push_back(scatter);
  std::string text = head;
  for (std::size_t i = 0; i < parts.size(); ++i) text += (i == 0 ? "" : "; ") + parts[i];
  return text + ".";
}

}  // namespace rigcal::fleet
