#include "storage/work/recomputations.h"

#include <algorithm>

#include "server/base/digests/sha256.h"
#include "storage/audit.h"
#include "storage/database/query.h"

namespace rigcal::storage {
namespace {

std::string RecomputationSubject(const RobotId& robot) { return "re-computation of robot " + robot.str(); }

Digest DigestOfRun(const RecomputationRun& run, const std::vector<RobotAsked>& robots) {
  std::string text = run.software + "\n" + run.estimator + "\n" + run.scope + "\n" + run.subject;
  for (const RobotAsked& robot : robots) {
    text += "\n" + robot.robot.str();
    for (const SessionAsked& session : robot.sessions) text += "\n " + session.session.str() + " " + session.sizes;
  }
  return Sha256Of(text);
}

// The newest run of that digest, if it still has something to do or left nothing out.
std::optional<std::int64_t> SameRun(Store& store, const Digest& digest) {
  Query query(
      store,
      "SELECT c.number, EXISTS (SELECT 1 FROM recomputation_robot r JOIN waiting_recomputed_robot w ON w.robot_number "
      "= "
      "r.number WHERE r.run_number = c.number), EXISTS (SELECT 1 FROM recomputation_robot r JOIN recomputed_robot d ON "
      "d.robot_number = r.number WHERE r.run_number = c.number AND d.how = 'failed') OR EXISTS (SELECT 1 FROM "
      "recomputation_robot r JOIN recomputation_session i ON i.robot_number = r.number JOIN recomputed_session d ON "
      "d.item_number = i.number WHERE r.run_number = c.number AND d.how IN ('kept', 'failed')) "
      "FROM recomputation c WHERE c.digest = ? ORDER BY c.number DESC LIMIT 1");
  if (!query.Bind(digest).Step()) return std::nullopt;
  const bool waits = query.Int(1) != 0, left_out = query.Int(2) != 0;
  return waits || !left_out ? std::optional(query.Int(0)) : std::nullopt;
}

Status InsertSessionAsked(Store& store, std::int64_t robot_number, const SessionAsked& session) {
  const auto number = Query(store,
                            "INSERT INTO recomputation_session (robot_number, session_number, sizes) "
                            "SELECT ?, number, ? FROM session WHERE session_id = ? RETURNING number")
                          .Bind(robot_number, session.sizes, session.session)
                          .RunForKey();
  if (!number)
    return Fail(ErrorCode::kNotFound, "session " + session.session.str() + " is not known",
                "`rigcal sessions` lists those that are.");
  Query(store, "INSERT INTO waiting_recomputed_session VALUES (?, ?)").Bind(robot_number, number).Run();
  return {};
}

Status InsertRobot(Store& store, std::int64_t run, const RobotAsked& robot) {
  const std::int64_t number =
      Query(store, "INSERT INTO recomputation_robot (run_number, robot_id) VALUES (?, ?) RETURNING number")
          .Bind(run, robot.robot)
          .RunForKey()
          .value();
  Query(store, "INSERT INTO waiting_recomputed_robot VALUES (?)").Bind(number).Run();
  for (const SessionAsked& session : robot.sessions) RIGCAL_TRY(InsertSessionAsked(store, number, session));
  return {};
}

Result<std::int64_t> InsertRun(Store& store, const RecomputationRun& run, const std::vector<RobotAsked>& robots) {
  const std::int64_t number =
      Query(store,
            "INSERT INTO recomputation (digest, scope, subject, asked_ns, who, software, estimator) VALUES (?, ?, ?, "
            "?, ?, ?, ?) "
            "RETURNING number")
          .Bind(DigestOfRun(run, robots), run.scope, run.subject, run.asked_at, run.who, run.software, run.estimator)
          .RunForKey()
          .value();
  for (const RobotAsked& robot : robots) RIGCAL_TRY(InsertRobot(store, number, robot));
  const RobotId about(run.scope == "robot" ? run.subject : "");
  RIGCAL_TRY(AppendAudit(
      store, run.asked_at, run.who,
      "asked for run " + std::to_string(number) + " of `rigcal resolve`: " + ScopeText(run) + ", " + CauseText(run),
      about));
  return number;
}

constexpr const char* kItemColumns =
    "SELECT i.number, r.number, r.run_number, r.robot_id, s.session_id, i.sizes, c.estimator FROM "
    "waiting_recomputed_session w "
    "CROSS JOIN recomputation_session i ON i.number = w.item_number CROSS JOIN recomputation_robot r ON r.number = "
    "w.robot_number "
    "CROSS JOIN recomputation c ON c.number = r.run_number CROSS JOIN session s ON s.number = i.session_number ";

RecomputationItem ItemAt(const Query& query) {
  return {query.Int(0),  query.Int(1), query.Int(2), query.IdAt<RobotId>(3), query.IdAt<SessionId>(4),
          query.Text(5), query.Text(6)};
}

// Its first session that waits, else the robot itself.
RecomputationItem NextOfRobot(Store& store, RecomputationItem robot) {
  Query query(store, std::string(kItemColumns) + "WHERE w.robot_number = ? ORDER BY w.item_number LIMIT 1");
  return query.Bind(robot.robot_number).Step() ? ItemAt(query) : std::move(robot);
}

}  // namespace

Result<RunAsked> AppendRecomputation(Store& store, const RecomputationRun& run, const std::vector<RobotAsked>& robots) {
  return Append<RunAsked>(store, "re-computation", [&]() -> Result<RunAsked> {
    if (const auto same = SameRun(store, DigestOfRun(run, robots))) return RunAsked{*same, false};
    RIGCAL_ASSIGN(const std::int64_t number, InsertRun(store, run, robots));
    return RunAsked{number, true};
  });
}

Result<std::optional<RecomputationItem>> LoadNextRecomputation(Store& store, const std::vector<RobotId>& busy_robots) {
  using Found = std::optional<RecomputationItem>;
  return Load<Found>(store, "next re-computation", [&]() -> Result<Found> {
    Query query(
        store,
        "SELECT r.number, r.run_number, r.robot_id, c.estimator FROM waiting_recomputed_robot w CROSS JOIN "
        "recomputation_robot r "
        "ON r.number = w.robot_number CROSS JOIN recomputation c ON c.number = r.run_number ORDER BY w.robot_number");
    while (query.Step()) {
      const RobotId robot = query.IdAt<RobotId>(2);
      if (std::find(busy_robots.begin(), busy_robots.end(), robot) != busy_robots.end()) continue;
      return Found(NextOfRobot(store, {0, query.Int(0), query.Int(1), robot, {}, "", query.Text(3)}));
    }
    return Found();
  });
}

Result<std::optional<RecomputationItem>> LoadRecomputedItem(Store& store, std::int64_t number) {
  using Found = std::optional<RecomputationItem>;
  return Load<Found>(store, "re-computation", [&]() -> Result<Found> {
    Query query(store, std::string(kItemColumns) +
                           "WHERE w.item_number = ?1 AND w.robot_number = (SELECT robot_number FROM "
                           "recomputation_session WHERE number = ?1)");
    return query.Bind(number).Step() ? Found(ItemAt(query)) : std::nullopt;
  });
}

std::string WorkOfRecomputation(const RecomputationItem& item) {
  return item.session.empty() ? "resolve robot " + std::to_string(item.robot_number)
                              : "resolve " + std::to_string(item.number);
}

Status FinishRecomputedSession(Store& store, const RecomputationItem& item, SessionAnew how, const std::string& why,
                               Stamp now) {
  return store.connection().Append(RecomputationSubject(item.robot), [&]() -> Status {
    Query(store,
          "INSERT INTO recomputed_session SELECT ?, ?, ?, CASE ?3 WHEN 'kept' THEN (SELECT e.estimator FROM "
          "recomputation_session i "
          "JOIN session_estimate e ON e.session_number = i.session_number WHERE i.number = ?1 ORDER BY "
          "substr(e.estimator, instr(e.estimator || ' ', ' ') + 1) = i.sizes DESC, e.rowid DESC LIMIT 1) END, ?")
        .Bind(item.number, now, NameOf(how), why)
        .Run();
    Query(store, "DELETE FROM waiting_recomputed_session WHERE robot_number = ? AND item_number = ?")
        .Bind(item.robot_number, item.number)
        .Run();
    return {};
  });
}

Status FinishRecomputedRobot(Store& store, const RecomputationItem& item, const RecomputedRobot& done,
                             std::int64_t edge_watermark, Stamp now) {
  return store.connection().Append(RecomputationSubject(item.robot), [&]() -> Status {
    const auto positive = [](int number) { return number > 0 ? std::optional(number) : std::nullopt; };
    Query(store, "INSERT INTO recomputed_robot VALUES (?, ?, ?, ?, ?, ?, ?, ?)")
        .Bind(item.robot_number, item.robot, now, NameOf(done.how), positive(done.revision), positive(done.against),
              edge_watermark, done.why)
        .Run();
    for (const PoseChange& change : done.changes) {
      const bool moved = change.how == "moved";
      Query(store, "INSERT INTO recomputed_change VALUES (?, ?, ?, ?, ?, ?)")
          .Bind(item.robot_number, change.sensor, change.how, moved ? std::optional(change.moved_m) : std::nullopt,
                moved ? std::optional(change.turned_rad) : std::nullopt, change.sigma_ratio)
          .Run();
    }
    Query(store, "DELETE FROM waiting_recomputed_robot WHERE robot_number = ?").Bind(item.robot_number).Run();
    return {};
  });
}

}  // namespace rigcal::storage
