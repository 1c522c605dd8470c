// The list of all robots: what is asked of it, and a page of it.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "server/model/robot_summary.h"

namespace rigcal {

inline constexpr std::size_t kFleetRowsMax = 100;                            // of one page
inline constexpr std::int64_t kQuiet_ns = 30LL * 24 * 3600 * 1'000'000'000;  // "quiet" for longer

// Each part comes from the address of a page and may be anything.
struct FleetQuery {
  std::string search;   // words that a robot's row must hold: its id, level and reason of its verdict, its worst edge
  // "pass", "warn", "fail", "unknown", "overdue", "off" (an edge beyond 3 sigma), "quiet" (no session for 30 days);
  // empty: all
  std::string verdict;
  // "robot", "calibrated", "session", "worst", "revision", "sessions", "edges"; else by urgency
  std::string sort;
  bool descending = false;
  std::size_t page = 1;
};

struct FleetPage {
  std::vector<RobotSummary> rows;
  std::size_t matches = 0, pages = 1, page = 1;  // `page` asked for beyond the last is the last
};

// Of all robots.
struct FleetCounts {
  std::int64_t robots = 0, overdue = 0, sessions = 0, edges = 0, jobs_waiting = 0;
  std::map<VerdictLevel, std::int64_t> verdicts;
};

}  // namespace rigcal
