// The status of robots as it was told last, and its changes: those that come with a revision, and those that come with
// the time.
#pragma once

#include <vector>

#include "server/model/robots/robot_status.h"
#include "storage/store.h"

namespace rigcal::storage {

// Compares what the robot's summary says as of `now` with what was noted last; a change is noted, and is an alert, in
// the same transaction. No alert is the first status of a robot. While its newest revision is being worked out nothing
// is noted, nor that a robot does not run what is in use before it had the time to apply it (robot_runs.h). Call inside
// the Write that replaces the summary (robot_summary.h).
[[nodiscard]] Status NoteStatus(Store& store, const RobotId& robot, Stamp now);
// Robots whose summary says another status as of `now` than was noted last: up to `max`, in the order of their names.
// What changed with the time is among them.
[[nodiscard]] Result<std::vector<RobotId>> LoadChangedStatuses(Store& store, Stamp now, int max);

// The status of a row of summary_robot as SQL; `?1` is now. As robots/robot_status.h has it: a test holds one against
// the other.
[[nodiscard]] std::string StatusSql();
// Likewise: whether it needs somebody, also one that may drive, with something to mend by a day.
[[nodiscard]] std::string HasWorkSql();

}  // namespace rigcal::storage
