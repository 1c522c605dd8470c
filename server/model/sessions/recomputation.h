// Stored sessions computed again with the software of today: what was asked for, how far it is, what would change.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "server/base/ids.h"
#include "server/base/stamp.h"
#include "server/model/graph/pose_change.h"

namespace rigcal {

// Who asked for what, and what computes it.
struct RecomputationRun {
  std::int64_t number = 0;     // order of arrival, from 1
  std::string scope, subject;  // "all", ""; "model", its name; "robot", its id; "board", its serial
  std::string who;
  Stamp asked_at;
  std::string software, estimator;  // "0.2.0", "joint/7"
};
// "all robots", "rig model mars", "robot mapper-01", "the robots that board B-7 was shown to"
[[nodiscard]] std::string ScopeText(const RecomputationRun& run);
// Of what came of it: "re-computed with rigcal 0.2.0, estimator joint/7"; of a board also "with its measured size".
[[nodiscard]] std::string CauseText(const RecomputationRun& run);

// What is to be computed, robot by robot in this order.
struct SessionAsked {
  SessionId session;
  std::string sizes;  // measured square sizes (formats/boards/square_sizes.h); empty: those of the session
};
struct RobotAsked {
  RobotId robot;
  std::vector<SessionAsked> sessions;
};

// How it ended for a session: `kKept` could not be computed again and stays as it is.
enum class SessionAnew { kComputed, kSame, kKept, kFailed };
// The spelling in documents: "computed" | "same" | "kept" | "failed".
[[nodiscard]] std::string NameOf(SessionAnew how);

// How it ended for a robot: a new candidate, the same bytes as its newest revision, or nothing.
enum class RobotAnew { kChanged, kUnchanged, kFailed };
// "changed" | "unchanged" | "failed", and back; what is not known is failed.
[[nodiscard]] std::string NameOf(RobotAnew how);
[[nodiscard]] RobotAnew RobotAnewOf(const std::string& name);

// Of one run: of how many sessions and robots, and how many of them ended in each way.
struct RecomputationProgress {
  std::int64_t sessions = 0, computed = 0, same = 0, kept = 0, failed_sessions = 0;
  std::int64_t older =
      0;  // of these robots, than what is computed: they say nothing of a calibration, and stay as they are
  std::int64_t robots = 0, changed = 0, unchanged = 0, failed_robots = 0;
  // Ended, in whatever way. A run is done with its robots, as these come after their sessions.
  [[nodiscard]] std::int64_t sessions_done() const { return computed + same + kept + failed_sessions; }
  [[nodiscard]] std::int64_t robots_done() const { return changed + unchanged + failed_robots; }
  [[nodiscard]] bool is_done() const { return robots_done() == robots; }
};

// Of a robot that is done.
struct RecomputedRobot {
  RobotId robot;
  RobotAnew how = RobotAnew::kFailed;
  int revision = 0;                 // the candidate; 0: there is none
  int against = 0;                  // compared with this revision: in use then, else the newest; 0: none
  std::string why;                  // of a failed one
  std::vector<PoseChange> changes;  // the largest first
};

// A session that was not computed again.
struct SessionLeft {
  RobotId robot;
  SessionId session;
  SessionAnew how = SessionAnew::kKept;
  std::string why;
};

}  // namespace rigcal
