// Reports that the disk need not keep, as all that they show is stored: which of them stay, and how one whose folder is
// gone (removed, or not in a backup that was restored) is drawn again, with the same bytes.
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <mutex>
#include <optional>
#include <string>
#include <utility>

#include "server/base/ids.h"
#include "storage/revisions/revisions.h"
#include "storage/store.h"

namespace rigcal::pipeline {

struct Freed {
  int reports = 0;
  std::int64_t bytes = 0;  // of files that no other report has
};
// Of the robot's reports on disk the newest `kept` stay, the newest of each month (UTC) in which revisions were made,
// and that of the revision that robots use.
[[nodiscard]] Result<Freed> RemoveOldReports(storage::Store& store, const RobotId& robot, std::int64_t kept);

// Why reports could not be drawn when it was last tried. Any thread.
class UndrawnReports {
 public:
  // The newest reason replaces an older one.
  void Note(const storage::RevisionKey& key, const Error& error);
  // It was drawn.
  void Forget(const storage::RevisionKey& key);
  // Nothing where it did not fail since the start, or was drawn since.
  [[nodiscard]] std::optional<Error> Find(const storage::RevisionKey& key) const;

 private:
  mutable std::mutex mutex_;
  std::map<std::pair<RobotId, int>, Error> why_;
};

// `file` of that report is not there: why, and what will be. Has the report drawn again if all of it is gone; then
// `drawn_soon` is called. kBusy: it is being drawn; kNotFound: there is no such thing, or drawing it failed.
[[nodiscard]] Error WhyMissing(storage::Store& store, const UndrawnReports& undrawn, const storage::RevisionKey& key,
                               const std::string& file, const std::function<void()>& drawn_soon);

// After a start: the newest reports of the next robots after `after`, by id, will be drawn again where they are gone.
// The last robot that it looked at; empty where none was left.
[[nodiscard]] Result<RobotId> DrawMissingReports(storage::Store& store, const RobotId& after);

}  // namespace rigcal::pipeline
