#include "storage/work/jobs.h"

#include "storage/database/query.h"

namespace rigcal::storage {
namespace {

std::string JobSubject(std::int64_t number) { return "job " + std::to_string(number); }

JobRow JobRowOf(const Query& query) {
  return {query.Int(0), query.IdAt<RobotId>(1), query.IdAt<SessionId>(2),
          SensorPair{query.IdAt<SensorId>(3), query.IdAt<SensorId>(4)}, static_cast<int>(query.Int(5))};
}

bool Exists(Store& store, std::int64_t number) {
  return Query(store, "SELECT 1 FROM job WHERE number = ?").Bind(number).Step();
}

constexpr const char* kNeverBegun =
    "SELECT j.number, w.robot_id, s.session_id, j.sensor_a, j.sensor_b, 0 FROM waiting_job w "
    "CROSS JOIN job j ON j.number = w.job_number CROSS JOIN session s ON s.number = j.session_number "
    "WHERE NOT EXISTS (SELECT 1 FROM waiting_attempt t WHERE t.work = 'job ' || w.job_number) "
    "AND w.robot_id NOT IN (SELECT value FROM json_each(?)) ORDER BY w.job_number LIMIT 1";
constexpr const char* kBegunBefore =
    "SELECT j.number, w.robot_id, s.session_id, j.sensor_a, j.sensor_b, t.attempts FROM waiting_attempt t "
    "CROSS JOIN waiting_job w ON w.job_number = CASE substr(t.work, 1, 4) WHEN 'job ' THEN CAST(substr(t.work, 5) AS "
    "BIGINT) END "
    "CROSS JOIN job j ON j.number = w.job_number CROSS JOIN session s ON s.number = j.session_number "
    "WHERE substr(t.work, 1, 4) = 'job ' AND w.robot_id NOT IN (SELECT value FROM json_each(?)) ORDER BY t.attempts, "
    "w.job_number LIMIT 1";

// Of robots other than those.
std::optional<JobRow> FirstOf(Store& store, const char* sql, const std::vector<RobotId>& others) {
  Query query(store, sql);
  return query.Bind(ListOf(others)).Step() ? std::optional(JobRowOf(query)) : std::nullopt;
}

}  // namespace

Result<std::optional<JobRow>> LoadNextJob(Store& store, const std::vector<RobotId>& busy_robots,
                                          const std::vector<RobotId>& served_robots) {
  std::vector<RobotId> busy_or_served = busy_robots;
  busy_or_served.insert(busy_or_served.end(), served_robots.begin(), served_robots.end());
  return Load<std::optional<JobRow>>(store, "next job", [&]() -> Result<std::optional<JobRow>> {
    if (auto job = FirstOf(store, kNeverBegun, busy_or_served)) return job;
    if (auto job = FirstOf(store, kNeverBegun, busy_robots)) return job;
    return FirstOf(store, kBegunBefore, busy_robots);
  });
}

Result<bool> IsJobWaiting(Store& store, std::int64_t number) {
  return Load<bool>(store, JobSubject(number), [&]() -> Result<bool> {
    return Query(store, "SELECT 1 FROM waiting_job WHERE job_number = ?").Bind(number).Step();
  });
}

Result<std::int64_t> CountJobs(Store& store) {
  return Load<std::int64_t>(store, "jobs of all robots", [&]() -> Result<std::int64_t> {
    Query query(store, "SELECT count(*) FROM waiting_job");
    return query.Step() ? query.Int(0) : 0;
  });
}

Result<std::int64_t> CountJobs(Store& store, const RobotId& robot) {
  return Load<std::int64_t>(store, "jobs of robot " + robot.str(), [&]() -> Result<std::int64_t> {
    Query query(store, "SELECT count(*) FROM waiting_job WHERE robot_id = ?");
    return query.Bind(robot).Step() ? query.Int(0) : 0;
  });
}

Result<std::optional<Stamp>> LoadOldestQueuedAt(Store& store) {
  return Load<std::optional<Stamp>>(store, "the oldest job", [&]() -> Result<std::optional<Stamp>> {
    Query query(store,
                "SELECT j.queued_ns FROM waiting_job w CROSS JOIN job j ON j.number = w.job_number "
                "WHERE NOT EXISTS (SELECT 1 FROM job_finished f WHERE f.job_number = w.job_number) ORDER BY "
                "w.job_number LIMIT 1");
    return query.Step() ? std::optional(Stamp{query.Int(0)}) : std::nullopt;
  });
}

Result<JobCount> CountJobs(Store& store, const SessionId& session) {
  return Load<JobCount>(store, "jobs of session " + session.str(), [&]() -> Result<JobCount> {
    Query query(store,
                "SELECT count(w.job_number), count(*) FROM session s JOIN job j ON j.session_number = s.number "
                "LEFT JOIN waiting_job w ON w.job_number = j.number WHERE s.session_id = ?");
    return query.Bind(session).Step() ? JobCount{query.Int(0), query.Int(1)} : JobCount{};
  });
}

Status QueueAgain(Store& store, const EdgeId& edge) {
  return store.connection().Append("the job of edge " + edge.str(), [&]() -> Status {
    Query(
        store,
        "INSERT INTO waiting_job SELECT j.number, e.robot_id FROM edge e JOIN session s ON s.session_id = e.session_id "
        "JOIN job j ON j.session_number = s.number AND j.sensor_a = e.frame_a AND j.sensor_b = e.frame_b "
        "WHERE e.edge_id = ? ON CONFLICT DO NOTHING")
        .Bind(edge)
        .Run();
    return {};
  });
}

Status FinishJob(Store& store, std::int64_t number, Stamp now) {
  return store.connection().Append(JobSubject(number), [&]() -> Status {
    if (!Exists(store, number))
      return Fail(ErrorCode::kNotFound, JobSubject(number) + " is not known", "Take jobs from the queue.");
    Query(store, "INSERT INTO job_finished VALUES (?, ?) ON CONFLICT DO NOTHING").Bind(number, now).Run();
    Query(store, "DELETE FROM waiting_job WHERE job_number = ?").Bind(number).Run();
    return {};
  });
}

}  // namespace rigcal::storage
