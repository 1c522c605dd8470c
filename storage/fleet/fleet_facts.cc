#include "storage/fleet/fleet_facts.h"

#include "storage/database/query.h"

namespace rigcal::storage {

Status AppendWorstEdge(Store& store, const RevisionKey& key, const WorstEdge& worst) {
  return store.connection().Append("worst edge of robot " + key.robot.str(), [&]() -> Status {
    Query(store, "INSERT INTO revision_worst_edge VALUES (?, ?, ?, ?, ?)")
        .Bind(key.robot, key.number, worst.frame_a, worst.frame_b, worst.in_sigmas)
        .Run();
    return {};
  });
}

Result<std::optional<WorstEdge>> LoadWorstEdge(Store& store, const RevisionKey& key) {
  using Worst = std::optional<WorstEdge>;
  return Load<Worst>(store, "worst edge of robot " + key.robot.str(), [&]() -> Result<Worst> {
    Query query(
        store,
        "SELECT frame_a, frame_b, residual_ratio FROM revision_worst_edge WHERE robot_id = ? AND revision_number = ?");
    if (!query.Bind(key.robot, key.number).Step()) return std::nullopt;
    return WorstEdge{query.IdAt<SensorId>(0), query.IdAt<SensorId>(1), query.Real(2)};
  });
}

Status AppendCauseKeys(Store& store, const RevisionKey& key, const std::vector<std::string>& causes) {
  return store.connection().Append("causes of robot " + key.robot.str(), [&]() -> Status {
    for (const std::string& cause : causes)
      Query(store, "INSERT INTO revision_cause VALUES (?, ?, ?)").Bind(key.robot, key.number, cause).Run();
    return {};
  });
}

Result<std::vector<std::string>> LoadCauseKeys(Store& store, const RevisionKey& key) {
  using Keys = std::vector<std::string>;
  return Load<Keys>(store, "causes of robot " + key.robot.str(), [&]() -> Result<Keys> {
    Query query(store,
                "SELECT cause_key FROM revision_cause WHERE robot_id = ? AND revision_number = ? ORDER BY cause_key");
    query.Bind(key.robot, key.number);
    Keys keys;
    while (query.Step()) keys.push_back(query.Text(0));
    return keys;
  });
}

Result<std::map<SessionId, SessionFacts>> LoadSessionFacts(Store& store, const std::vector<SessionId>& sessions) {
  using Facts = std::map<SessionId, SessionFacts>;
  return Load<Facts>(store, "results of sessions", [&]() -> Result<Facts> {
    Facts facts;
    Query query(store,
                "SELECT e.session_id, count(*) FILTER (WHERE e.state = 'good'), count(*) FILTER (WHERE e.state = "
                "'failed') FROM edge e "
                "WHERE e.session_id IN (SELECT value FROM json_each(?)) "
                "AND EXISTS (SELECT 1 FROM counted_edge c WHERE c.edge_number = e.number) GROUP BY e.session_id");
    query.Bind(ListOf(sessions));
    while (query.Step()) facts[query.IdAt<SessionId>(0)] = {query.Int(1), query.Int(2)};
    return facts;
  });
}

}  // namespace rigcal::storage
