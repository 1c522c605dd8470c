// What a row of summary_robot is asked, as SQL: the choices, the words and the orders of a FleetQuery, and what is
// counted by them. For storage/*.cc only.
#pragma once

#include <string>
#include <vector>

#include "server/model/robots/fleet_list.h"
#include "storage/database/query.h"

namespace rigcal::storage {

// When it is due, as DueAt (model/robots/robot_status.h) has it; NULL where there is no date.
inline const std::string kDue_ns =
    "min(calibrated_ns + max_age_ns, coalesce(drift_due_ns, calibrated_ns + max_age_ns))";
// Never, or nothing that was measured counts any more: there is no date.
inline const std::string kIsNotCalibrated = "(revision_number = 0 OR calibrated_ns IS NULL)";
// `?1`, `?2`, `?3`, which BindDue binds: what is valid until before the first is overdue. Else it is due this week, a
// date by drift that is past with it, or by the end of the next, or later: of a calibrated row one of the four.
inline const std::string kIsOverdue =
    "(revision_number > 0 AND calibrated_ns IS NOT NULL AND calibrated_ns + max_age_ns < ?1)";
inline const std::string kIsDueThisWeek =
    "(revision_number > 0 AND calibrated_ns + max_age_ns >= ?1 AND " + kDue_ns + " < ?2)";
inline const std::string kIsDueNextWeek =
    "(revision_number > 0 AND calibrated_ns + max_age_ns >= ?1 AND " + kDue_ns + " >= ?2 AND " + kDue_ns + " < ?3)";
inline const std::string kIsDueLater =
    "(revision_number > 0 AND calibrated_ns + max_age_ns >= ?1 AND " + kDue_ns + " >= ?3)";
// As DriveRuleOf (model/robots/drive_rule.h) has it of the newest revision; `?1` as above.
[[nodiscard]] std::string DriveKindSql();
// That the newest revision is not what robots are to have.
inline const std::string kIsNotInUse = "(revision_number > 0 AND coalesce(usable_number, 0) <> revision_number)";
// The first parameters of a query with any of these.
void BindDue(Query& query, Stamp now);

// "FROM ... WHERE ..." of the robots that are asked for. `words`: those of its search.
[[nodiscard]] std::string MatchesSql(const std::vector<std::string>& words);
// All parameters of that, in a query that begins with them.
void BindMatches(Query& query, const FleetQuery& asked, const std::vector<std::string>& words, Stamp now);
// " ORDER BY ..." of a query with these parameters.
[[nodiscard]] std::string OrderSql(const FleetQuery& asked);

}  // namespace rigcal::storage
