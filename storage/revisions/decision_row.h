// Which decisions hold, in SQL. For storage/*.cc only.
#pragma once

#include <string>

#include "server/base/ids.h"

namespace rigcal::storage {

[[nodiscard]] inline std::string DecisionsSubject(const RobotId& robot) { return "decisions about robot " + robot.str(); }

// Of a decision `d` to use a revision.
inline const std::string kNotRolledBack =
    "NOT EXISTS (SELECT 1 FROM decision b WHERE b.robot_id = d.robot_id AND b.how = 'rolled_back' AND b.number > "
    "d.number AND b.revision_number < d.revision_number)";
// That nobody rejected its revision after it.
inline const std::string kNotRejected =
    "NOT EXISTS (SELECT 1 FROM decision r WHERE r.robot_id = d.robot_id AND "
    "r.revision_number = d.revision_number AND r.number > d.number AND r.how = 'rejected')";
// That it holds.
inline const std::string kHolds = "d.how <> 'rejected' AND " + kNotRejected + " AND " + kNotRolledBack;

}  // namespace rigcal::storage
