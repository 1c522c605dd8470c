// A row of summary_robot: what of it is read, and the text in it by which robots are sorted and searched. For
// storage/*.cc only.
#pragma once

#include <string>
#include <vector>

#include "server/model/robots/robot_summary.h"
#include "storage/database/query.h"

namespace rigcal::storage {

inline constexpr const char* kSummaryColumns =
    "robot_id, revision_number, verdict, verdict_why, verdict_what_to_do, calibrated_ns, usable_number, "
    "usable_created_ns, "
    "calculating, given_up, sessions, edges, jobs_waiting, last_session_ns, worst_frame_a, worst_frame_b, worst_ratio, "
    "causes, "
    "max_age_ns, unverified, state, runs_revision, runs_trouble, found, found_why, found_next_step, drift_due_ns, "
    "drift_sensor, "
    "drift_law, drift_visits, drift_robots, site, runs_what, rig_model, operator_name, calibrations, apply_by_ns";
// Of a query whose first columns are these; overdue as of `now`.
[[nodiscard]] RobotSummary SummaryOf(const Query& query, Stamp now);

// Byte by byte it sorts ids as people count: "robot-9" before "robot-10".
[[nodiscard]] std::string NameKeyOf(const RobotId& robot);
// What a robot's row holds, in lower case, but for what changes with the time.
[[nodiscard]] std::string SearchTextOf(const RobotSummary& summary);
// The words of a search, in lower case.
[[nodiscard]] std::vector<std::string> SearchWordsOf(const std::string& search);

// Keys of causes, which hold no character that JSON escapes, as json_each takes them; and back.
[[nodiscard]] std::string ListOfKeys(const std::vector<std::string>& keys);
[[nodiscard]] std::vector<std::string> KeysOfList(const std::string& list);

}  // namespace rigcal::storage
