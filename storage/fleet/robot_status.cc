#include "storage/fleet/robot_status.h"

#include "storage/alerts/outbox.h"
#include "storage/database/query.h"
#include "storage/fleet/fleet_sql.h"
#include "storage/fleet/summary_row.h"

namespace rigcal::storage {
namespace {

std::string StatusSubject(const RobotId& robot) { return "the status of robot " + robot.str(); }

std::optional<StatusWord> NotedStatus(Store& store, const RobotId& robot) {
  Query query(store, "SELECT status FROM robot_status WHERE robot_id = ? ORDER BY number DESC LIMIT 1");
  return query.Bind(robot).Step() ? std::optional(StatusWordOf(query.Text(0))) : std::nullopt;
}

std::optional<RobotSummary> StoredSummary(Store& store, const RobotId& robot, Stamp now) {
  Query query(store, std::string("SELECT ") + kSummaryColumns + " FROM summary_robot WHERE robot_id = ?");
  return query.Bind(robot).Step() ? std::optional(SummaryOf(query, now)) : std::nullopt;
}

// A robot that is about to do what it is to do is no news.
bool MayStillApply(const RobotSummary& robot, Stamp now) {
  return robot.runs && robot.runs->apply_by && now < *robot.runs->apply_by;
}

void InsertStatus(Store& store, const RobotId& robot, const CalibrationStatus& status, Stamp now) {
  Query(store, "INSERT INTO robot_status (robot_id, at_ns, status, why, next_step) VALUES (?, ?, ?, ?, ?)")
      .Bind(robot, now, NameOf(status.word), status.why, status.next_step)
      .Run();
}

}  // namespace

Status NoteStatus(Store& store, const RobotId& robot, Stamp now) {
  return store.connection().Append(StatusSubject(robot), [&]() -> Status {
    const auto summary = StoredSummary(store, robot, now);
    if (!summary || summary->validity.calculating) return {};
    const CalibrationStatus status = StatusAt(*summary, now);
    if (status.word == StatusWord::kNotApplied && MayStillApply(*summary, now)) return {};
    const std::optional<StatusWord> before = NotedStatus(store, robot);
    if (before == status.word) return {};
    InsertStatus(store, robot, status, now);
    if (!before) return {};
    return AppendAlert(store, formats::StatusAlert(robot, summary->revision, *before, status, now));
  });
}

std::string StatusSql() {
  return "(CASE WHEN revision_number = 0 THEN 'unknown' WHEN verdict = 'fail' THEN 'failed' "
         "WHEN found = 'out-of-tolerance' THEN found WHEN verdict = 'unknown' THEN 'unknown' WHEN " +
         kIsNotCalibrated + " THEN 'unknown' WHEN " + kIsOverdue +
         " THEN 'overdue' WHEN runs_trouble <> '' THEN 'not-applied' WHEN found = 'drifted' THEN found WHEN " +
         kIsNotInUse + " AND (state = 'candidate' OR usable_number IS NULL) THEN 'to-approve' WHEN " + kDue_ns +
         " - ?1 <= " + std::to_string(kDueSoon_ns) + " THEN 'due' ELSE 'ok' END)";
}

std::string HasWorkSql() { return "(" + StatusSql() + " <> 'ok' OR verdict = 'warn')"; }

Result<std::vector<RobotId>> LoadChangedStatuses(Store& store, Stamp now, int max) {
  using Robots = std::vector<RobotId>;
  return Load<Robots>(store, "the status of robots", [&]() -> Result<Robots> {
    Query query(store,
                "SELECT robot_id FROM summary_robot s WHERE calculating = 0 AND NOT (apply_by_ns IS NOT NULL "
                "AND ?1 < apply_by_ns AND " +
                    StatusSql() + " = 'not-applied') AND " + StatusSql() +
                    " <> coalesce((SELECT status FROM robot_status r WHERE r.robot_id = s.robot_id ORDER BY "
                    "number DESC LIMIT 1), '') ORDER BY name_key LIMIT ?2");
    query.Bind(now, max);
    Robots robots;
    while (query.Step()) robots.push_back(query.IdAt<RobotId>(0));
    return robots;
  });
}

}  // namespace rigcal::storage
