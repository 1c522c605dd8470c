// What the store says of a robot at a glance: of one worked out now, of those that lists show stored, and worked out
// anew where something changed.
#pragma once

#include <mutex>
#include <optional>
#include <set>
#include <vector>

#include "server/formats/answers/parameters.h"
#include "server/model/robots/robot_summary.h"
#include "storage/sessions/sessions.h"
#include "storage/store.h"

namespace rigcal::pipeline {

// READ, worked out now. kNotFound for a robot that the store does not know.
[[nodiscard]] Result<storage::RobotRow> LoadKnownRobot(storage::Store& store, const RobotId& robot);
// Likewise.
[[nodiscard]] Result<RobotSummary> LoadRobotSummary(storage::Store& store, const RobotId& robot, Stamp now);
// Of a robot without a revision, that has a batch of edges which is not whole: what is missing of it.
[[nodiscard]] Result<std::optional<Error>> IncompleteBatch(storage::Store& store, const RobotId& robot);

// Whose summaries are worked out next, from one time to the next.
struct SummaryTurn {
  RobotId after;             // who was taken up last: the others come before it comes again
  std::set<RobotId> unmade;  // robots whose summary a fault of the store or of ours has prevented; it was logged
  std::mutex taken;          // by whoever works some out
};
struct RefreshedSummaries {
  int made = 0;
  bool more = false;  // some were made, and more wait
};
// Up to `max` of those that wait. Several threads may do so at the same time: what is newer stays. A robot whose
// summary cannot be made waits on, and keeps no other waiting; it is logged once. An error is the store's as a whole.
[[nodiscard]] Result<RefreshedSummaries> RefreshSummaries(storage::Store& store, const Clock& clock, int max,
                                                          SummaryTurn& turn);
// That of one robot, if it waits.
[[nodiscard]] Status RefreshSummary(storage::Store& store, const Clock& clock, const RobotId& robot);
// All that wait, before anybody is served: after a migration those of the whole fleet. What fails is logged, and waits
// on.
void RefreshAllSummaries(storage::Store& store, const Clock& clock);

// Before a list is read: some that wait, so that it shows what somebody was just told. Those that could not be kept,
// because the store is busy or takes nothing (a full disk).
std::vector<RobotSummary> FreshenSummaries(storage::Store& store, const Clock& clock);

struct RobotList {
  std::vector<RobotSummary> robots;  // by id
  std::optional<RobotId> next = {};  // of a part: the last of it, empty where nothing follows; absent: all that follow
};
// All robots, or the part that `limit`, `after` and `site` ask for (docs/api.md), freshened; overdue as of the clock.
// kNotFound where no robot is at the site, with those that may be meant.
[[nodiscard]] Result<RobotList> LoadRobotList(storage::Store& store, const Clock& clock,
                                              const formats::Parameters& parameters);

}  // namespace rigcal::pipeline
