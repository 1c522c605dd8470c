// Which decisions hold, in SQL. For storage/*.cc only.
#pragma once

#include <string>

#include "server/base/ids.h"

namespace rigcal::storage {

// How errors name them.
[[nodiscard]] inline std::string DecisionsSubject(const RobotId& robot) {
  return "decisions about robot " + robot.str();
}

// Of a decision `other`, that it counts: until `until`, an expression; empty: all do. No WITH: that would be worked out
// whole for each question.
[[nodiscard]] inline std::string DecidedUntil(const std::string& until, const std::string& other) {
  return until.empty() ? "" : " AND " + other + ".at_ns <= " + until;
}
// Of a decision `d` to use a revision.
[[nodiscard]] inline std::string NotRolledBack(const std::string& until = "") {
  return "NOT EXISTS (SELECT 1 FROM decision b WHERE b.robot_id = d.robot_id AND b.how = 'rolled_back' AND b.number > "
         "d.number AND b.revision_number < d.revision_number" +
         DecidedUntil(until, "b") + ")";
}
// That nobody rejected its revision after it.
[[nodiscard]] inline std::string NotRejected(const std::string& until = "") {
  return "NOT EXISTS (SELECT 1 FROM decision r WHERE r.robot_id = d.robot_id AND "
         "r.revision_number = d.revision_number AND r.number > d.number AND r.how = 'rejected'" +
         DecidedUntil(until, "r") + ")";
}
// That it holds.
[[nodiscard]] inline std::string DecisionHolds(const std::string& until = "") {
  return "d.how <> 'rejected' AND " + NotRejected(until) + " AND " + NotRolledBack(until);
}

}  // namespace rigcal::storage
