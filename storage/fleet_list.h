// The list of all robots, read from their summaries (robot_summary.h), and how many there are.
#pragma once

#include "server/model/fleet_list.h"
#include "storage/store.h"

namespace rigcal::storage {

// Call both inside one Read where a page shows both. Overdue and quiet are as of `now`.
[[nodiscard]] Result<FleetCounts> CountFleet(Store& store, Stamp now);
[[nodiscard]] Result<FleetPage> LoadFleetPage(Store& store, const FleetQuery& asked, Stamp now);

// Of what is stored, not of summaries; the same cost whatever the number of robots.
struct FleetSize {
  std::int64_t robots = 0, sessions = 0, edges = 0;  // edges that count
  std::int64_t unfinished = 0;                       // robots to solve or to judge, and reports to publish
};
[[nodiscard]] Result<FleetSize> LoadFleetSize(Store& store);

}  // namespace rigcal::storage
