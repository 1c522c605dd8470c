// Reports that the disk need not keep: all that they show is stored, and one that is asked for is drawn again
// (missing_report.h).
#pragma once

#include <cstdint>

#include "server/base/ids.h"
#include "storage/store.h"

namespace rigcal::pipeline {

struct Freed {
  int reports = 0;
  std::int64_t bytes = 0;  // of files that no other report has
};
// Of the robot's reports on disk the newest `kept` stay, the newest of each month (UTC) in which revisions were made,
// and that of the revision that robots use.
[[nodiscard]] Result<Freed> RemoveOldReports(storage::Store& store, const RobotId& robot, std::int64_t kept);

}  // namespace rigcal::pipeline
