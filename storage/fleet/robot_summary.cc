#include "storage/fleet/robot_summary.h"

#include "storage/database/query.h"
#include "storage/fleet/calibration_series.h"
#include "storage/fleet/summary_row.h"

namespace rigcal::storage {
namespace {

std::string SummarySubject(const RobotId& robot) { return "summary of robot " + robot.str(); }

WaitingSummary WaitingOf(const Query& query) { return {query.IdAt<RobotId>(0), query.Int(1)}; }

void InsertSummary(Store& store, const RobotSummary& summary, std::int64_t changes) {
  using Text = std::string;
  const Validity& validity = summary.validity;
  const auto& usable = validity.usable;
  const auto& worst = summary.worst;
  const auto& drift = summary.drift_due;
  Query(store,
        "INSERT INTO summary_robot (robot_id, changes, name_key, revision_number, verdict, calibrated_ns, "
        "last_session_ns, "
        "worst_ratio, sessions, edges, jobs_waiting, search, calculating, usable_number, usable_created_ns, "
        "worst_frame_a, "
        "worst_frame_b, verdict_why, verdict_what_to_do, given_up, causes, max_age_ns, unverified, state, "
        "runs_revision, runs_trouble, "
        "runs_what, found, found_why, found_next_step, drift_due_ns, drift_sensor, drift_law, drift_visits, "
        "drift_robots, site, "
        "rig_model, operator_name, calibrations, apply_by_ns) VALUES (?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, "
        "?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?) ON CONFLICT (robot_id) DO NOTHING")
      .Bind(summary.robot, changes, NameKeyOf(summary.robot), summary.revision, NameOf(summary.verdict.level))
      .Bind(validity.calibrated_at, summary.last_session_at, worst ? std::optional(worst->in_sigmas) : std::nullopt)
      .Bind(summary.sessions, summary.edges, summary.jobs_waiting, SearchTextOf(summary), validity.calculating)
      .Bind(usable ? std::optional(usable->number) : std::nullopt,
            usable ? std::optional(usable->created_at) : std::nullopt)
      .Bind(worst ? worst->frame_a.str() : Text(), worst ? worst->frame_b.str() : Text())
      .Bind(summary.verdict.why, summary.verdict.what_to_do, validity.given_up, ListOfKeys(summary.causes))
      .Bind(validity.max_age_ns, summary.verdict.unverified, NameOf(summary.state))
      .Bind(summary.runs ? std::optional(summary.runs->revision) : std::nullopt,
            summary.runs ? summary.runs->trouble : Text(), summary.runs ? summary.runs->what : Text())
      .Bind(NameOf(summary.found.word), summary.found.why, summary.found.next_step)
      .Bind(drift ? std::optional(drift->at) : std::nullopt, drift ? drift->sensor.str() : Text(),
            drift ? NameOf(drift->law) : Text(), drift ? drift->visits : 0, drift ? drift->robots : 0, summary.site)
      .Bind(summary.rig_model, summary.operator_name, TextOfCalibrations(summary.calibrations),
            summary.runs ? summary.runs->apply_by : std::nullopt)
      .Run();
}

}  // namespace

RobotSummary SummaryOf(const Query& query, Stamp now) {
  RobotSummary summary;
  summary.robot = query.IdAt<RobotId>(0);
  summary.revision = static_cast<int>(query.Int(1));
  summary.verdict = {VerdictLevelOf(query.Text(2)), query.Text(3), query.Text(4), query.Text(19)};
  Validity& validity = summary.validity;
  if (!query.IsNull(5)) validity.calibrated_at = query.Time(5);
  validity.max_age_ns = query.Int(18);
  validity.overdue = summary.revision > 0 && IsOverdue(validity.calibrated_at, validity.max_age_ns, now);
  if (!query.IsNull(6))  // the dates of a row are its own
    validity.usable =
        UsableRevision{static_cast<int>(query.Int(6)), query.Time(7), validity.calibrated_at, validity.max_age_ns};
  validity.approved = IsApproved(summary.verdict, summary.revision, validity.usable);
  validity.calculating = query.Int(8) != 0;
  validity.given_up = query.Text(9);
  summary.sessions = query.Int(10);
  summary.edges = query.Int(11);
  summary.jobs_waiting = query.Int(12);
  if (!query.IsNull(13)) summary.last_session_at = query.Time(13);
  if (!query.IsNull(16)) summary.worst = WorstEdge{query.IdAt<SensorId>(14), query.IdAt<SensorId>(15), query.Real(16)};
  summary.causes = KeysOfList(query.Text(17));
  summary.state = RevisionStateOf(query.Text(20));
  summary.found = {StatusWordOf(query.Text(23)), query.Text(24), query.Text(25)};
  if (!query.IsNull(26))
    summary.drift_due = DriftDue{query.IdAt<SensorId>(27), query.Time(26), DriftLawOf(query.Text(28)),
                                 static_cast<int>(query.Int(29)), static_cast<int>(query.Int(30))};
  summary.site = query.Text(31);
  summary.rig_model = query.Text(33);
  summary.operator_name = query.Text(34);
  summary.calibrations = CalibrationsOfText(query.Text(35));
  if (!query.IsNull(21)) summary.runs = Runs{static_cast<int>(query.Int(21)), query.Text(22), query.Text(32)};
  if (summary.runs && !query.IsNull(36)) summary.runs->apply_by = query.Time(36);
  return summary;
}

Result<std::vector<WaitingSummary>> LoadWaitingSummaries(Store& store, int max, const RobotId& after) {
  using Waiting = std::vector<WaitingSummary>;
  return Load<Waiting>(store, "summaries to make", [&]() -> Result<Waiting> {
    Waiting waiting;
    for (const char* where : {"robot_id > ?", "robot_id <= ?"}) {
      Query query(store, "SELECT robot_id, changes FROM waiting_summary WHERE " + std::string(where) +
                             " ORDER BY robot_id LIMIT ?");
      query.Bind(after, max - static_cast<int>(waiting.size()));
      while (query.Step()) waiting.push_back(WaitingOf(query));
    }
    return waiting;
  });
}

Result<std::optional<WaitingSummary>> LoadWaitingSummary(Store& store, const RobotId& robot) {
  using Waiting = std::optional<WaitingSummary>;
  return Load<Waiting>(store, SummarySubject(robot), [&]() -> Result<Waiting> {
    Query query(store, "SELECT robot_id, changes FROM waiting_summary WHERE robot_id = ?");
    return query.Bind(robot).Step() ? Waiting(WaitingOf(query)) : std::nullopt;
  });
}

Status ReplaceSummary(Store& store, const RobotSummary& summary, std::int64_t changes) {
  return store.connection().Append(SummarySubject(summary.robot), [&]() -> Status {
    Query(store, "DELETE FROM summary_robot WHERE robot_id = ? AND changes < ?").Bind(summary.robot, changes).Run();
    InsertSummary(store, summary, changes);
    Query(store, "DELETE FROM waiting_summary WHERE robot_id = ? AND changes = ?").Bind(summary.robot, changes).Run();
    return {};
  });
}

Result<std::vector<RobotSummary>> LoadSummaries(Store& store, const RobotId& after, std::optional<std::int64_t> max,
                                                Stamp now) {
  return Load<std::vector<RobotSummary>>(store, "list of robots", [&]() -> Result<std::vector<RobotSummary>> {
    Query query(store, std::string("SELECT ") + kSummaryColumns +
                           " FROM summary_robot WHERE robot_id > ? ORDER BY robot_id LIMIT ?");
    query.Bind(after, max.value_or(kAllRows));
    std::vector<RobotSummary> summaries;
    while (query.Step()) summaries.push_back(SummaryOf(query, now));
    return summaries;
  });
}

}  // namespace rigcal::storage
