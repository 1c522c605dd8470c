// What lists of robots and a robot's own page say of it at a glance.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "server/base/ids.h"
#include "server/base/stamp.h"
#include "server/model/approval/decision.h"
#include "server/model/approval/validity.h"
#include "server/model/diagnosis.h"
#include "server/model/robots/calibration_series.h"
#include "server/model/robots/robot_runs.h"
#include "server/model/robots/robot_status.h"

namespace rigcal {

// The edge of a revision that fits worst.
struct WorstEdge {
  SensorId frame_a, frame_b;
  double in_sigmas = 0.0;  // its residual over its own sigma
};
inline constexpr double kOff_sigmas = 3.0;  // from here on it is "off"

struct RobotSummary {
  RobotId robot;
  int revision = 0;  // the newest; 0: none yet
  Verdict verdict;   // of that revision; without one: why there is none
  // Of that revision; but age, what is allowed of it and `overdue` are of the revision in use, if there is one.
  // `overdue` as of the question, never without a revision.
  Validity validity;
  std::int64_t sessions = 0;
  std::int64_t edges = 0;                     // of that revision; without one: all that arrived
  std::int64_t jobs_waiting = 0;              // pairs to be calibrated
  std::optional<Stamp> last_session_at = {};  // captured; of those that came whole the newest; absent: none did
  std::optional<WorstEdge> worst = {};        // of that revision; absent: nothing checks an edge, or it was not kept
  std::vector<std::string> causes = {};  // of that revision: keys of cause.h, sorted; each is of some characters of ids
  RevisionState state = RevisionState::kUnusable;  // of that revision
  std::optional<Runs> runs = {};                   // what the robot says that it runs; absent: it never told
  CalibrationStatus found = {};                    // of that revision: the worst of its sensors, whatever the time
  std::optional<DriftDue> drift_due = {};  // the earliest date of the sensors of the revision in use, else of that one
  std::string site = {};                   // where it stands, as its newest session says; empty: not known
  std::vector<SensorStatus> sensors = {};  // of that revision, their dates as drift_due; not in lists
  VerdictBasis basis = {};                 // of `verdict`; not in lists
  std::string rig_model = {};              // as its newest closed session says that names one; empty: none does
  std::string operator_name = {};          // who captured last_session_at's session; empty: it does not say
  std::vector<CalibrationPoint> calibrations = {};  // of lists: to the second and to the thousandth of a sigma
};
// As of its StatusBasis (robot_status.h), and of what robots have: not-applied goes before drifted, to-approve before
// due. Whatever the word, the next step says what is to be approved or applied.
[[nodiscard]] CalibrationStatus StatusAt(const RobotSummary& robot, Stamp now);

}  // namespace rigcal
