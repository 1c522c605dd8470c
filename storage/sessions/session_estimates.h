// What the joint refinement of each session gave, once per session and version of the estimator.
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
struct SessionEstimateRow {
  SessionId session;
  std::optional<SessionEstimate> estimate;  // absent: not made yet by this estimator
};
// Of the robot's closed sessions, the newest captured first; at most `sessions_max` sessions are looked at.
[[nodiscard]] Result<std::vector<SessionEstimateRow>> LoadSessionEstimates(Store& store, const RobotId& robot,
                                                                           const std::string& estimator,
                                                                           int sessions_max);

}  // namespace rigcal::storage
