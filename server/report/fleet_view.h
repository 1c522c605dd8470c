// Which robots of a fleet a page shows, and in which order: pure, so that the same address shows the same.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "server/report/render.h"

namespace rigcal::report {

inline constexpr std::size_t kFleetRowsMax = 100;  // of one page

struct FleetSlice {
  std::vector<const FleetRow*> rows;
  std::size_t matches = 0, pages = 1, page = 1;
};
// `query.page` beyond the last is the last.
[[nodiscard]] FleetSlice SliceOf(const std::vector<FleetRow>& rows, const FleetQuery& query);

}  // namespace rigcal::report
