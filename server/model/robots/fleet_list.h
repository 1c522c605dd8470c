// The list of all robots: what is asked of it, and a page of it.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "server/model/robots/drive_rule.h"
#include "server/model/robots/robot_summary.h"

namespace rigcal {

inline constexpr std::size_t kFleetRowsMax = 100;                            // of one page
inline constexpr std::int64_t kQuiet_ns = 30LL * 24 * 3600 * 1'000'000'000;  // "quiet" for longer

// Each part comes from the address of a page and may be anything.
struct FleetQuery {
  std::string
      search;  // words that a robot's row must hold: what the list shows of it, dates as "31 Jan 2026" or 2026-01-31
  // "pass", "warn", "fail", "unknown"; a kind of drive rule (drive_rule.h); "off" (an edge beyond 3 sigma), "quiet" (no
  // session for 30 days), or by when it is due: "not_calibrated", "overdue", "this_week", "next_week", "later"; empty:
  // all
  std::string verdict;
  // "robot", "status", "model", "site", "calibrated", "due", "session", "operator", "worst", "revision", "sessions",
  // "edges"; else by urgency. Robots of which it is not known come last where it is a name or a date to come.
  std::string sort;
  bool descending = false;
  std::size_t page = 1;
  std::string cause = {};   // a key of cause.h; empty: all
  std::string status = {};  // of robot_status.h: "ok", "due", ...; kStatusWithWork; empty: all
  std::string site = {};    // as a robot's newest session names it; empty: all
  std::string model = {};   // rig model; empty: all
};

inline constexpr const char* kStatusWithWork = "work";  // all but "ok"

struct FleetPage {
  std::vector<RobotSummary> rows;
  std::size_t matches = 0, pages = 1, page = 1;  // `page` asked for beyond the last is the last
};

// Robots that have one cause of failed pairs in common.
struct CauseCount {
  std::string key;  // of cause.h
  std::int64_t robots = 0;
};
inline constexpr std::size_t kCausesListedMax = 12;

// Robots of one rig model.
struct ModelCount {
  std::string rig_model;
  std::int64_t robots = 0, with_work = 0;  // with_work: of another status than ok
};
inline constexpr std::size_t kModelsListedMax = 12;

// Of all robots.
struct FleetCounts {
  std::int64_t robots = 0, overdue = 0, sessions = 0, edges = 0, jobs_waiting = 0;
  std::int64_t not_calibrated = 0;  // without a revision, or it counts nothing: of no date, and not overdue
  std::map<VerdictLevel, std::int64_t> verdicts;
  std::map<DriveKind, std::int64_t> kinds = {};      // by what their drive rules say: each robot once
  std::map<StatusWord, std::int64_t> statuses = {};  // of each word, also where it is none
  // That are calibrated and not overdue, by when they will be.
  std::int64_t due_this_week = 0, due_next_week = 0, due_later = 0;
  std::vector<ModelCount> models =
      {};  // with the most work first, up to one more than are listed; not of robots of no model
  std::int64_t with_site = 0, with_operator = 0;  // of which one is known
  std::vector<CauseCount> causes = {};  // that most robots have: the most first, up to one more than are listed
};

// Weeks of work begin on Monday, 00:00 UTC. This is the next one.
[[nodiscard]] Stamp NextMonday(Stamp now);
inline constexpr std::int64_t kWeek_ns = 7LL * 24 * 3600 * 1'000'000'000;

}  // namespace rigcal
