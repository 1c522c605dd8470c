// What the joint refinement of each session gave, once per session, version of the estimator and sizes of boards.
#pragma once

#include <optional>
#include <vector>

#include "server/base/stamp.h"
#include "server/model/sessions/session_estimate.h"
#include "storage/store.h"

namespace rigcal::storage {

// `estimator` names what made it ("joint/2"); the same session by the same estimator again changes nothing.
[[nodiscard]] Status AppendSessionEstimate(Store& store, const SessionEstimate& estimate, const std::string& estimator,
                                           Stamp now);
// The name of what an estimate was made by: `sizes`, measured square sizes (recomputations.h), are part of it.
[[nodiscard]] std::string EstimatorNamed(const std::string& estimator, const std::string& sizes);
// `estimator` as EstimatorNamed gives it. False of a session that is not known.
[[nodiscard]] Result<bool> HasSessionEstimate(Store& store, const SessionId& session, const std::string& estimator);

// By what a session is estimated: as the newest re-computation said that is in effect, else by its own sizes. In effect
// is one whose candidate somebody approved, nobody rejected since (itself or a copy of it, rejections_sql.h), and
// behind which nobody rolled the robot back since (until what was in use then is approved again); one that changed
// nothing; and `run`, of which a candidate is made.
struct SessionBasis {
  SessionId session;
  std::string sizes;  // measured ones; empty: as the session states them
};
// Of the robot's closed sessions that count (neither superseded nor retired), the newest captured first, at most so
// many: the same whatever came or was said before.
[[nodiscard]] Result<std::vector<SessionBasis>> LoadSessionBases(Store& store, const RobotId& robot, int sessions_max);

struct SessionEstimateRow {
  SessionId session;
  std::optional<SessionEstimate> estimate;  // absent: not made yet by this estimator
  std::string sizes = {};                   // as of SessionBasis
};
// Likewise, each as it was `made_by`. Of a session that a re-computation kept as it is: by the estimator of then.
[[nodiscard]] Result<std::vector<SessionEstimateRow>> LoadSessionEstimates(Store& store, const RobotId& robot,
                                                                           const std::string& estimator,
                                                                           int sessions_max, std::int64_t run = 0);
// Of the sessions that count and were made current by a word after `standing` (standing.h), in the order in which they
// came: by `estimator`, or where it made none, as of one that is no more among the newest, by what made the last.
[[nodiscard]] Result<std::vector<SessionEstimate>> LoadSessionEstimatesSince(Store& store, const RobotId& robot,
                                                                             const std::string& estimator,
                                                                             std::int64_t standing);
// Of one session by one estimator, as EstimatorNamed gives it; nothing where there is none.
[[nodiscard]] Result<std::optional<SessionEstimate>> LoadSessionEstimate(Store& store, const SessionId& session,
                                                                         const std::string& estimator);

}  // namespace rigcal::storage
