#include "server/model/graph/connected.h"

#include <algorithm>

namespace rigcal {

std::vector<std::set<SensorId>> Connected(const std::vector<std::set<SensorId>>& groups) {
  std::vector<std::set<SensorId>> connected;  // no two share a sensor
  for (std::set<SensorId> whole : groups) {
    std::erase_if(connected, [&](const std::set<SensorId>& other) {
      const bool shares =
          std::any_of(other.begin(), other.end(), [&](const SensorId& sensor) { return whole.contains(sensor); });
      if (shares) whole.insert(other.begin(), other.end());
      return shares;
    });
    if (!whole.empty()) connected.push_back(std::move(whole));
  }
  std::sort(connected.begin(), connected.end());
  return connected;
}

}  // namespace rigcal
