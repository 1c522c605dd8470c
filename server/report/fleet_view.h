// Which robots of a fleet a page shows, and in which order: pure, so that the same address shows the same.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "server/report/render.h"
#include "server/report/sigmas.h"

namespace rigcal::report {

inline constexpr std::size_t kFleetRowsMax = 100;  // of one page
inline constexpr std::int64_t kQuiet_ns = 30LL * 24 * 3600 * 1'000'000'000;  // "quiet" for longer

struct FleetSlice {
  std::vector<const FleetRow*> rows;
  std::size_t matches = 0, pages = 1, page = 1;
};
// `query.page` beyond the last is the last.
[[nodiscard]] FleetSlice SliceOf(const std::vector<FleetRow>& rows, const FleetQuery& query, Stamp now = {});

}  // namespace rigcal::report
