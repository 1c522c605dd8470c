// The list of all robots, read from their summaries (robot_summary.h), and how many there are.
#pragma once

#include <functional>
#include <vector>

#include "server/model/robots/fleet_list.h"
#include "storage/store.h"

namespace rigcal::storage {

// Call both inside one Read where a page shows both. Overdue, due and quiet are as of `now`.
[[nodiscard]] Result<FleetCounts> CountFleet(Store& store, Stamp now);
[[nodiscard]] Result<FleetPage> LoadFleetPage(Store& store, const FleetQuery& asked, Stamp now);
// All that are asked for, whatever the page, one after the other.
[[nodiscard]] Status ForEachRobot(Store& store, const FleetQuery& asked, Stamp now,
                                  const std::function<void(const RobotSummary&)>& take);
// The causes that most robots have, the most first, up to `max`; the same cost whatever the number of robots.
// CountFleet has them with it.
[[nodiscard]] Result<std::vector<CauseCount>> LoadCauseCounts(Store& store, std::size_t max);

// Of what is stored, not of summaries; the same cost whatever the number of robots.
struct FleetSize {
  std::int64_t robots = 0, sessions = 0, edges = 0;  // edges that count
  std::int64_t unfinished = 0;  // pairs to calibrate, robots to solve or to judge, reports to publish
};
// Zeros of an empty store.
[[nodiscard]] Result<FleetSize> LoadFleetSize(Store& store);

}  // namespace rigcal::storage
