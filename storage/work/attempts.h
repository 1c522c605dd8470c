// How often a piece of work was begun: work that kills the process must not be begun for ever.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "server/base/stamp.h"
#include "storage/revisions/revisions.h"
#include "storage/store.h"

namespace rigcal::storage {

// The names of work.
[[nodiscard]] std::string WorkOfJob(std::int64_t job_number);
[[nodiscard]] std::string WorkOfReport(const RevisionKey& key);
[[nodiscard]] std::string WorkOfRevision(const RobotId& robot, std::int64_t edge_watermark,
                                         std::int64_t standing_watermark);

enum class AttemptEnd {
  kDone,       // the work is finished: nothing of it is counted any more
  kFailed,     // by a fault of ours, and counts
  kGivenBack,  // for a reason outside the work (an orderly stop, a full disk), and does not count
  kCutOff,     // the process died, and it counts
};

// An attempt is durable when this returns. One of the same work that is still open was cut off.
[[nodiscard]] Status BeginAttempt(Store& store, const std::string& work, Stamp now);
// Ends the one that is open; none: nothing, but that work which is done is forgotten. `why` is kept of a failed one.
[[nodiscard]] Status EndAttempt(Store& store, const std::string& work, AttemptEnd end, const std::string& why,
                                Stamp now);
// The same for every open attempt; the works that were open.
[[nodiscard]] Result<std::vector<std::string>> EndOpenAttempts(Store& store, AttemptEnd end, Stamp now);
constexpr int kKillsMax = 10;
// The same where the process was killed from outside: given back, but still work that was begun before; from the
// kKillsMax-th kill of the same work on cut off, for a cause that is always outside is none.
[[nodiscard]] Result<std::vector<std::string>> EndKilledAttempts(Store& store, Stamp now);

// The same for the open attempts of one robot: of whoever had it and is gone (leases.h), or stops.
[[nodiscard]] Result<std::vector<std::string>> EndKilledAttempts(Store& store, const RobotId& robot, Stamp now);
[[nodiscard]] Result<std::vector<std::string>> EndOpenAttempts(Store& store, const RobotId& robot, AttemptEnd end,
                                                               Stamp now);

// Attempts that count, of work that is not done; with the one under way.
[[nodiscard]] Result<std::map<std::string, int>> LoadAttemptCounts(Store& store);
struct Attempts {
  int failed = 0, cut_off = 0;  // one that is open is cut off, unless it is
  bool under_way = false;
  std::string newest_why;  // of those that failed
};
// Zeros of work that never began, or that is done.
[[nodiscard]] Result<Attempts> LoadAttempts(Store& store, const std::string& work);

}  // namespace rigcal::storage
