// Stored sessions to be computed again: runs, and what of them is still to be done. What is finished is noted in the
// transaction of its result, so that a run goes on where the process died.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "server/model/sessions/recomputation.h"
#include "storage/revisions/revisions.h"
#include "storage/store.h"

namespace rigcal::storage {

struct RunAsked {
  std::int64_t number = 0;
  bool is_new = false;
};
// Noted in the audit. `run.number` is not looked at. Asked again for the same (software, estimator, scope, robots,
// sessions and sizes) it is the same run, unless that one is done and left something out. Robots and sessions must be
// known.
[[nodiscard]] Result<RunAsked> AppendRecomputation(Store& store, const RecomputationRun& run,
                                                   const std::vector<RobotAsked>& robots);

// One piece of a run: a session, or with an empty session its robot, all sessions of which are done.
struct RecomputationItem {
  std::int64_t number = 0;        // of the session in its run
  std::int64_t robot_number = 0;  // of the robot in its run
  std::int64_t run = 0;
  RobotId robot;
  SessionId session;
  std::string sizes, estimator;
};
// Of the earliest robot that is not in `busy_robots`: robots are done one after the other.
[[nodiscard]] Result<std::optional<RecomputationItem>> LoadNextRecomputation(Store& store,
                                                                             const std::vector<RobotId>& busy_robots);
// A session by its number in its run; nothing: there is none, or it is done.
[[nodiscard]] Result<std::optional<RecomputationItem>> LoadRecomputedItem(Store& store, std::int64_t number);
// The names of such work (attempts.h).
[[nodiscard]] std::string WorkOfRecomputation(const RecomputationItem& item);

// Call inside Write with the session's estimate. `why`: of what was kept or failed. The last estimate that the session
// got with the item's sizes, by whatever estimator, goes on counting for one that was kept; of none the last at all.
[[nodiscard]] Status FinishRecomputedSession(Store& store, const RecomputationItem& item, SessionAnew how,
                                             const std::string& why, Stamp now);
// Call inside Write with the candidate. `edge_watermark`: that of the revision, of an unchanged robot of its newest.
[[nodiscard]] Status FinishRecomputedRobot(Store& store, const RecomputationItem& item, const RecomputedRobot& done,
                                           std::int64_t edge_watermark, Stamp now);

}  // namespace rigcal::storage
