// The stored summary of each robot: what lists say of it, replaced when something of it changed.
#pragma once

#include <optional>
#include <vector>

#include "server/model/robots/robot_summary.h"
#include "storage/store.h"

namespace rigcal::storage {

// A robot of which something changed since its summary was made. `changes` counts all that it ever had.
struct WaitingSummary {
  RobotId robot;
  std::int64_t changes = 0;
};
// Up to `max` of those that wait, by id: those after `after`, then the first ones.
[[nodiscard]] Result<std::vector<WaitingSummary>> LoadWaitingSummaries(Store& store, int max,
                                                                       const RobotId& after = {});
[[nodiscard]] Result<std::optional<WaitingSummary>> LoadWaitingSummary(Store& store, const RobotId& robot);
// Stores what was worked out in a snapshot in which the robot had so many `changes`; a no-op where that is older than
// what is stored. A robot that changed since then waits on. `validity.overdue` is not stored.
[[nodiscard]] Status ReplaceSummary(Store& store, const RobotSummary& summary, std::int64_t changes);

// Sorted by id: those after `after`, at most `max` of them (absent: all); overdue as of `now`. Nothing of a robot that
// still waits for its first summary.
[[nodiscard]] Result<std::vector<RobotSummary>> LoadSummaries(Store& store, const RobotId& after,
                                                              std::optional<std::int64_t> max, Stamp now);

}  // namespace rigcal::storage
