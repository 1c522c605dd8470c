#include "tests/bench/fleet/fleet_tally.h"

#include <algorithm>
#include <cmath>
#include <sstream>

namespace rigcal::drawn_fleet {
namespace {

std::string Quoted(const std::string& text) { return '"' + text + '"'; }
std::string Quoted(int number) { return Quoted(std::to_string(number)); }

std::string JsonOf(const Quiet& quiet) {
  return "{\"sessions\": " + std::to_string(quiet.sessions) + ", \"accused\": " + std::to_string(quiet.accused) + "}";
}

// Python's, of what nothing would tell.
std::string JsonOf(double number) {
  std::ostringstream json;
  json << number;
  return std::isfinite(number) ? json.str() : "Infinity";
}

std::string JsonOf(const Events& events) {
  std::ostringstream json;
  json << "{\"sessions\": " << events.sessions << ", \"found\": " << events.found << ", \"axis\": " << events.axis
       << ", \"named\": " << events.named << ", \"for_sure\": " << events.for_sure
       << ", \"smallest_mm\": " << JsonOf(1e3 * events.smallest_m / std::max(1, events.shifts))
       << ", \"smallest_deg\": "
       << JsonOf(57.29577951308232 * events.smallest_rad / std::max(1, events.sessions - events.shifts)) << "}";
  return json.str();
}

std::string JsonOf(const std::vector<int>& weeks) {
  std::string json = "[";
  for (const int one : weeks) json += (json.size() > 1 ? ", " : "") + std::to_string(one);
  return json + "]";
}

std::string JsonOf(const Drifts& drifts) {
  return "{\"robots\": " + std::to_string(drifts.robots) + ", \"wrong\": " + std::to_string(drifts.wrong) +
         ", \"weeks\": " + JsonOf(drifts.weeks) + ", \"weeks_until_rate\": " + JsonOf(drifts.weeks_until_rate) + "}";
}

template <typename Key, typename Value>
std::string JsonOf(const std::map<Key, Value>& values) {
  std::string json;
  for (const auto& [key, value] : values) json += (json.empty() ? "" : ", ") + Quoted(key) + ": " + JsonOf(value);
  return "{" + json + "}";
}

}  // namespace

bool IsAccused(const AsFound& found) { return StateOf(found) == FoundState::kDrifted; }

void Count(const AsFound& found, const SensorId& sensor, int axis, double step, Events& events) {
  ++events.sessions;
  events.shifts += axis < 3 ? 1 : 0;
  (axis < 3 ? events.smallest_m : events.smallest_rad) += std::abs(step);
  events.found += IsAccused(found) ? 1 : 0;
  int accused = 0;
  const SensorFound* moved = nullptr;
  for (const SensorFound& one : found.sensors) {
    accused += one.state == FoundState::kDrifted ? 1 : 0;
    if (one.sensor == sensor) moved = &one;
  }
  if (moved == nullptr || moved->state != FoundState::kDrifted) return;
  events.axis += moved->axes[static_cast<std::size_t>(axis)] == FoundState::kDrifted ? 1 : 0;
  events.named += accused == 1 ? 1 : 0;
  events.for_sure += accused == 1 && moved->or_else.empty() ? 1 : 0;
}

std::string JsonOf(const FleetTally& tally) {
  std::ostringstream json;
  json << "\"quiet\": " << JsonOf(tally.quiet) << ", \"told_moved\": " << JsonOf(tally.told_moved)
       << ", \"told_apart\": " << JsonOf(tally.told_apart) << ", \"remarks_apart\": " << JsonOf(tally.remarks_apart)
       << ", \"events\": " << JsonOf(tally.events) << ", \"bumps\": " << JsonOf(tally.bumps)
       << ", \"drifts\": " << JsonOf(tally.drifts) << ", \"swaps\": {\"sessions\": " << tally.swaps
       << ", \"told\": " << tally.swaps_told << ", \"accused\": " << tally.swaps_accused
       << "}, \"missed\": " << tally.missed << ", \"missed_and_told_later\": " << tally.missed_later;
  return "{" + json.str() + "}";
}

}  // namespace rigcal::drawn_fleet
