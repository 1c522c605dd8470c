#include "storage/fleet_facts.h"

#include "storage/query.h"

namespace rigcal::storage {

Status AppendWorstEdge(Store& store, const RevisionKey& key, const WorstEdge& worst) {
  return store.connection().Append("worst edge of robot " + key.robot.str(), [&]() -> Status {
    Query(store, "INSERT INTO revision_worst_edge VALUES (?, ?, ?, ?, ?)")
        .Bind(key.robot, key.number, worst.frame_a, worst.frame_b, worst.in_sigmas)
        .Run();
    return {};
  });
}

Result<std::map<RobotId, FleetFacts>> LoadFleetFacts(Store& store) {
  using Facts = std::map<RobotId, FleetFacts>;
  return Load<Facts>(store, "facts of all robots", [&]() -> Result<Facts> {
    Facts facts;
    Query sessions(
        store,
        "SELECT s.robot_id, max(s.captured_ns) FROM session s JOIN session_closed c ON c.session_number = s.number "
        "GROUP BY s.robot_id");
    while (sessions.Step()) facts[sessions.IdAt<RobotId>(0)].last_session_at = sessions.Time(1);
    Query worst(store,
                "SELECT w.robot_id, w.frame_a, w.frame_b, w.residual_ratio FROM revision_worst_edge w WHERE "
                "w.revision_number = (SELECT max(number) FROM revision r WHERE r.robot_id = w.robot_id)");
    while (worst.Step())
      facts[worst.IdAt<RobotId>(0)].worst = WorstEdge{worst.IdAt<SensorId>(1), worst.IdAt<SensorId>(2), worst.Real(3)};
    return facts;
  });
}

Result<std::map<SessionId, SessionFacts>> LoadSessionFacts(Store& store, const std::vector<SessionId>& sessions) {
  using Facts = std::map<SessionId, SessionFacts>;
  return Load<Facts>(store, "results of sessions", [&]() -> Result<Facts> {
    Facts facts;
    Query query(store,
                "SELECT e.session_id, sum(e.state = 'good'), sum(e.state = 'failed') FROM edge e "
                "WHERE e.session_id IN (SELECT value FROM json_each(?)) "
                "AND EXISTS (SELECT 1 FROM counted_edge c WHERE c.edge_number = e.number) GROUP BY e.session_id");
    query.Bind(ListOf(sessions));
    while (query.Step()) facts[query.IdAt<SessionId>(0)] = {query.Int(1), query.Int(2)};
    return facts;
  });
}

}  // namespace rigcal::storage
