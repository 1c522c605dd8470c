#include "storage/work/recomputation_result.h"

#include "storage/database/query.h"

namespace rigcal::storage {
namespace {

std::string RunSubject(std::int64_t run) { return "re-computation " + std::to_string(run); }

const std::string kRunColumns =
    "SELECT c.number, c.scope, c.subject, c.who, c.asked_ns, c.software, c.estimator FROM recomputation c ";

RecomputationRun RunAt(const Query& query) {
  return {query.Int(0), query.Text(1), query.Text(2), query.Text(3), query.Time(4), query.Text(5), query.Text(6)};
}

std::vector<PoseChange> ChangesOf(Store& store, std::int64_t robot_number) {
  Query query(store,
              "SELECT sensor, how, moved_m, turned_rad, sigma_ratio FROM recomputed_change WHERE robot_number = ? "
              "ORDER BY how = 'moved', sigma_ratio DESC NULLS LAST, moved_m DESC NULLS LAST, sensor");
  query.Bind(robot_number);
  std::vector<PoseChange> changes;
  while (query.Step()) {
    changes.push_back({query.IdAt<SensorId>(0), query.Text(1), query.Real(2), query.Real(3), {}});
    if (!query.IsNull(4)) changes.back().sigma_ratio = query.Real(4);
  }
  return changes;
}

}  // namespace

Result<std::optional<RecomputationRun>> LoadRecomputation(Store& store, std::int64_t run) {
  using Found = std::optional<RecomputationRun>;
  return Load<Found>(store, RunSubject(run), [&]() -> Result<Found> {
    Query query(store,
                kRunColumns + "WHERE c.number = coalesce(nullif(?, 0), (SELECT max(number) FROM recomputation))");
    return query.Bind(run).Step() ? Found(RunAt(query)) : std::nullopt;
  });
}

Result<RecomputationProgress> LoadRecomputationProgress(Store& store, std::int64_t run) {
  return Load<RecomputationProgress>(store, RunSubject(run), [&]() -> Result<RecomputationProgress> {
    RecomputationProgress progress;
    Query sessions(
        store,
        "SELECT count(*), count(*) FILTER (WHERE d.how = 'computed'), count(*) FILTER (WHERE d.how = 'same'), "
        "count(*) FILTER (WHERE d.how = 'kept'), count(*) FILTER (WHERE d.how = 'failed') FROM recomputation_robot r "
        "CROSS JOIN recomputation_session i ON i.robot_number = r.number "
        "LEFT JOIN recomputed_session d ON d.item_number = i.number WHERE r.run_number = ?");
    if (sessions.Bind(run).Step()) {
      progress.sessions = sessions.Int(0), progress.computed = sessions.Int(1), progress.same = sessions.Int(2);
      progress.kept = sessions.Int(3), progress.failed_sessions = sessions.Int(4);
    }
    Query older(store,
                "SELECT count(*) FROM recomputation_robot r CROSS JOIN session s ON s.robot_id = r.robot_id "
                "AND s.captured_ns < (SELECT min(t.captured_ns) FROM recomputation_session i CROSS JOIN session t "
                "ON t.number = i.session_number WHERE i.robot_number = r.number) "
                "JOIN session_closed c ON c.session_number = s.number WHERE r.run_number = ?");
    if (older.Bind(run).Step()) progress.older = older.Int(0);
    Query robots(
        store,
        "SELECT count(*), count(*) FILTER (WHERE d.how = 'changed'), count(*) FILTER (WHERE d.how = 'unchanged'), "
        "count(*) FILTER (WHERE d.how = 'failed') "
        "FROM recomputation_robot r LEFT JOIN recomputed_robot d ON d.robot_number = r.number WHERE r.run_number = ?");
    if (robots.Bind(run).Step()) {
      progress.robots = robots.Int(0), progress.changed = robots.Int(1), progress.unchanged = robots.Int(2);
      progress.failed_robots = robots.Int(3);
    }
    return progress;
  });
}

Result<std::vector<RecomputedRobot>> LoadRecomputedRobots(Store& store, std::int64_t run, std::int64_t limit) {
  using Robots = std::vector<RecomputedRobot>;
  return Load<Robots>(store, RunSubject(run), [&]() -> Result<Robots> {
    Query query(
        store,
        "SELECT r.number, r.robot_id, d.how, d.revision_number, d.against_number, d.why, "
        "(SELECT max(coalesce(sigma_ratio, 1e300)) FROM recomputed_change h WHERE h.robot_number = r.number) AS effect "
        "FROM recomputation_robot r CROSS JOIN recomputed_robot d ON d.robot_number = r.number WHERE r.run_number = ? "
        "ORDER BY d.how = 'unchanged', d.how = 'failed', effect DESC NULLS LAST, r.robot_id LIMIT ?");
    query.Bind(run, limit);
    Robots robots;
    while (query.Step())
      robots.push_back({query.IdAt<RobotId>(1), RobotAnewOf(query.Text(2)), static_cast<int>(query.Int(3)),
                        static_cast<int>(query.Int(4)), query.Text(5), ChangesOf(store, query.Int(0))});
    return robots;
  });
}

Result<std::vector<SessionLeft>> LoadSessionsLeft(Store& store, std::int64_t run, std::int64_t limit) {
  using Sessions = std::vector<SessionLeft>;
  return Load<Sessions>(store, RunSubject(run), [&]() -> Result<Sessions> {
    Query query(
        store,
        "SELECT r.robot_id, s.session_id, d.how, d.why FROM recomputation_robot r CROSS JOIN recomputation_session i "
        "ON "
        "i.robot_number = r.number CROSS JOIN recomputed_session d ON d.item_number = i.number CROSS JOIN session s ON "
        "s.number = i.session_number WHERE r.run_number = ? AND d.how IN ('kept', 'failed') ORDER BY r.robot_id, "
        "s.session_id LIMIT ?");
    query.Bind(run, limit);
    Sessions sessions;
    while (query.Step())
      sessions.push_back({query.IdAt<RobotId>(0), query.IdAt<SessionId>(1),
                          query.Text(2) == NameOf(SessionAnew::kKept) ? SessionAnew::kKept : SessionAnew::kFailed,
                          query.Text(3)});
    return sessions;
  });
}

Result<std::optional<RecomputationRun>> LoadCauseOf(Store& store, const RevisionKey& key) {
  using Found = std::optional<RecomputationRun>;
  return Load<Found>(
      store, "revision " + std::to_string(key.number) + " of robot " + key.robot.str(), [&]() -> Result<Found> {
        Query query(store, kRunColumns +
                               "JOIN recomputation_robot r ON r.run_number = c.number JOIN recomputed_robot d ON "
                               "d.robot_number = r.number "
                               "WHERE d.robot_id = ? AND d.revision_number = ? ORDER BY c.number LIMIT 1");
        return query.Bind(key.robot, key.number).Step() ? Found(RunAt(query)) : std::nullopt;
      });
}

Result<bool> AwaitsPerson(Store& store, const RobotId& robot, int number, std::int64_t edge_watermark) {
  return Load<bool>(store, "re-computed candidates of robot " + robot.str(), [&]() -> Result<bool> {
    return Query(store,
                 "SELECT 1 FROM recomputed_robot d WHERE d.robot_id = ? AND d.revision_number <= ? AND "
                 "d.edge_watermark >= ? "
                 "AND NOT EXISTS (SELECT 1 FROM decision t WHERE t.robot_id = d.robot_id AND t.revision_number >= "
                 "d.revision_number) LIMIT 1")
        .Bind(robot, number, edge_watermark)
        .Step();
  });
}

}  // namespace rigcal::storage
