// Work that a stored session or edge still asks for. Unfinished jobs are found again after a crash.
#pragma once

#include <optional>
#include <vector>

#include "server/model/sessions/session.h"
#include "storage/store.h"

namespace rigcal::storage {

struct JobRow {
  std::int64_t number = 0;
  RobotId robot;
  SessionId session;
  SensorPair pair;
  int attempts = 0;  // that count (attempts.h)
};

// The oldest unfinished job of a robot that is not in `busy_robots` (one writer per robot at a time), of those not in
// `served_robots` first; what was begun before and not finished comes after all others, the least often begun first.
[[nodiscard]] Result<std::optional<JobRow>> LoadNextJob(Store& store, const std::vector<RobotId>& busy_robots,
                                                        const std::vector<RobotId>& served_robots = {});
// False where it is finished by now.
[[nodiscard]] Result<bool> IsJobWaiting(Store& store, std::int64_t number);
// Unfinished ones, of all robots or of one.
[[nodiscard]] Result<std::int64_t> CountJobs(Store& store);
[[nodiscard]] Result<std::int64_t> CountJobs(Store& store, const RobotId& robot);
// When the oldest of those that wait was queued; nothing: none waits. Those that wait once more (QueueAgain) do not
// count.
[[nodiscard]] Result<std::optional<Stamp>> LoadOldestQueuedAt(Store& store);
// Unfinished and all jobs of one session.
struct JobCount {
  std::int64_t waiting = 0, total = 0;
};
// Zeros of a session that is not known.
[[nodiscard]] Result<JobCount> CountJobs(Store& store, const SessionId& session);
// The job that made this edge, once more: its evidence is made again. A no-op for an edge that was pushed.
[[nodiscard]] Status QueueAgain(Store& store, const EdgeId& edge);
[[nodiscard]] Status FinishJob(Store& store, std::int64_t number, Stamp now);  // call inside Write with the edge

}  // namespace rigcal::storage
