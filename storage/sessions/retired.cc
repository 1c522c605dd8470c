#include "storage/sessions/retired.h"

#include <algorithm>

#include "storage/audit.h"
#include "storage/sessions/standing.h"
#include "storage/sessions/standing_row.h"

namespace rigcal::storage {
namespace {

// What a word is about: `key` is its value in a column of the table standing.
template <typename Key>
struct SaidOf {
  RobotId robot;
  std::string column, name;  // name: for people
  Key key;
};

// That are retired now, of the robot ?1: `id` is what it is known by, `same` says that a later word is about the same.
std::string RetiredOf(const std::string& id, const std::string& from, const std::string& same) {
  return "SELECT " + id + ", t.number, t.how, t.at_ns, t.who, t.reason FROM standing t " + from +
         " WHERE t.robot_id = ?1 AND t.how = 'retired' AND " + id +
         " IS NOT NULL AND NOT EXISTS (SELECT 1 FROM standing later WHERE " + same +
         " AND later.number > t.number AND later.how = 'restored')";
}

template <typename AnId>
Result<std::map<AnId, Standing>> LoadRetiredBy(Store& store, const RobotId& robot, const std::string& sql) {
  using Retired = std::map<AnId, Standing>;
  return Load<Retired>(store, "what was retired of robot " + robot.str(), [&]() -> Result<Retired> {
    Query query(store, sql);
    query.Bind(robot);
    Retired retired;
    while (query.Step()) retired[query.IdAt<AnId>(0)] = StandingAt(query, 1);
    return retired;
  });
}

template <typename Key>
bool IsRetiredNow(Store& store, const SaidOf<Key>& thing) {
  Query query(store, "SELECT how FROM standing WHERE robot_id = ? AND " + thing.column +
                         " = ? AND how IN ('retired', 'restored') ORDER BY number DESC LIMIT 1");
  return query.Bind(thing.robot, thing.key).Step() && query.Text(0) == "retired";
}

// `how`: "retired" or "restored".
template <typename Key>
Status Say(Store& store, const SaidOf<Key>& thing, const std::string& how, const Word& word) {
  if (IsRetiredNow(store, thing) == (how == "retired")) return {};
  const auto number = Query(store, "INSERT INTO standing (robot_id, at_ns, how, " + thing.column +
                                       ", who, reason) VALUES (?, ?, ?, ?, ?, ?) RETURNING number")
                          .Bind(thing.robot, word.at, how, thing.key, word.who, word.reason)
                          .RunForKey();
  const AuditedRow row{AuditedKind::kStanding, number.value()};
  return AppendAudit(store, word.at, word.who,
                     how + " " + thing.name + " of robot " + thing.robot.str() + Because(word), thing.robot, row);
}

Result<SaidOf<std::int64_t>> EdgeSaidOf(Store& store, const EdgeId& id) {
  Query query(store, "SELECT robot_id, number FROM edge WHERE edge_id = ?");
  if (query.Bind(id).Step())
    return SaidOf<std::int64_t>{query.IdAt<RobotId>(0), "edge_number", "edge " + id.str(), query.Int(1)};
  return Fail(ErrorCode::kNotFound, "edge " + id.str() + " is not known", "`rigcal edges ROBOT` lists those that are.");
}

Result<SaidOf<std::int64_t>> SessionSaidOf(Store& store, const SessionId& id) {
  Query query(store,
              "SELECT s.robot_id, s.number, c.closed_ns FROM session s LEFT JOIN session_closed c ON c.session_number "
              "= s.number "
              "WHERE s.session_id = ?");
  if (!query.Bind(id).Step())
    return Fail(ErrorCode::kNotFound, "session " + id.str() + " is not known",
                "`rigcal sessions` lists those that are.");
  if (query.IsNull(2))
    return Fail(ErrorCode::kConflict, "session " + id.str() + " did not come whole: it does not count",
                "There is nothing to retire.");
  return SaidOf<std::int64_t>{query.IdAt<RobotId>(0), "session_number", "session " + id.str(), query.Int(1)};
}

Result<SaidOf<SensorId>> SensorSaidOf(Store& store, const RobotId& robot, const SensorId& sensor) {
  RIGCAL_ASSIGN(const bool is_known, HasSensor(store, robot, sensor));
  if (is_known) return SaidOf<SensorId>{robot, "sensor_id", "sensor " + sensor.str(), sensor};
  return Fail(ErrorCode::kNotFound, "robot " + robot.str() + " has no sensor " + sensor.str(),
              "`rigcal show " + robot.str() + "` lists its sensors.");
}

Status SayOfEdge(Store& store, const EdgeId& id, const std::string& how, const Word& word) {
  RIGCAL_TRY(CheckWord(word));
  return store.connection().Append("standing of edge " + id.str(), [&]() -> Status {
    RIGCAL_ASSIGN(const auto edge, EdgeSaidOf(store, id));
    return Say(store, edge, how, word);
  });
}

Status SayOfSensor(Store& store, const RobotId& robot, const SensorId& sensor, const std::string& how,
                   const Word& word) {
  RIGCAL_TRY(CheckWord(word));
  return store.connection().Append("standing of sensor " + sensor.str(), [&]() -> Status {
    RIGCAL_ASSIGN(const auto thing, SensorSaidOf(store, robot, sensor));
    return Say(store, thing, how, word);
  });
}

}  // namespace

Status RetireEdge(Store& store, const EdgeId& id, const Word& word) { return SayOfEdge(store, id, "retired", word); }

Status RestoreEdge(Store& store, const EdgeId& id, const Word& word) { return SayOfEdge(store, id, "restored", word); }

Status RetireSession(Store& store, const SessionId& id, const Word& word) {
  RIGCAL_TRY(CheckWord(word));
  return store.connection().Append("standing of session " + id.str(), [&]() -> Status {
    RIGCAL_ASSIGN(const auto session, SessionSaidOf(store, id));
    return Say(store, session, "retired", word);
  });
}

Status RetireSensor(Store& store, const RobotId& robot, const SensorId& sensor, const Word& word) {
  return SayOfSensor(store, robot, sensor, "retired", word);
}

Status RestoreSensor(Store& store, const RobotId& robot, const SensorId& sensor, const Word& word) {
  return SayOfSensor(store, robot, sensor, "restored", word);
}

Result<bool> HasSensor(Store& store, const RobotId& robot, const SensorId& sensor) {
  return Load<bool>(store, "sensor " + sensor.str() + " of robot " + robot.str(), [&]() -> Result<bool> {
    return Query(store,
                 "SELECT 1 FROM listed_sensor WHERE robot_id = ?1 AND sensor_id = ?2 UNION ALL SELECT 1 FROM edge e "
                 "JOIN counted_edge c ON c.edge_number = e.number WHERE e.robot_id = ?1 AND ?2 IN (e.frame_a, "
                 "e.frame_b) LIMIT 1")
        .Bind(robot, sensor)
        .Step();
  });
}

Result<std::vector<SensorId>> LoadSensorsOf(Store& store, const RobotId& robot) {
  return Load<std::vector<SensorId>>(store, "sensors of robot " + robot.str(), [&]() -> Result<std::vector<SensorId>> {
    Query query(
        store,
        "SELECT sensor_id FROM listed_sensor WHERE robot_id = ?1 UNION SELECT e.frame_a FROM counted_edge c "
        "JOIN edge e ON e.number = c.edge_number WHERE c.robot_id = ?1 UNION SELECT e.frame_b FROM counted_edge c "
        "JOIN edge e ON e.number = c.edge_number WHERE c.robot_id = ?1");
    query.Bind(robot);
    std::vector<SensorId> sensors;
    while (query.Step()) sensors.push_back(query.IdAt<SensorId>(0));
    std::sort(sensors.begin(), sensors.end());
    return sensors;
  });
}

Result<std::map<EdgeId, Standing>> LoadRetired(Store& store, const RobotId& robot) {
  return LoadRetiredBy<EdgeId>(
      store, robot,
      RetiredOf("e.edge_id", "JOIN edge e ON e.number = t.edge_number", "later.edge_number = t.edge_number"));
}

Result<std::map<SessionId, Standing>> LoadRetiredSessions(Store& store, const RobotId& robot) {
  return LoadRetiredBy<SessionId>(store, robot,
                                  RetiredOf("s.session_id", "JOIN session s ON s.number = t.session_number",
                                            "later.session_number = t.session_number"));
}

Result<std::map<SensorId, Standing>> LoadRetiredSensors(Store& store, const RobotId& robot) {
  return LoadRetiredBy<SensorId>(
      store, robot, RetiredOf("t.sensor_id", "", "later.robot_id = t.robot_id AND later.sensor_id = t.sensor_id"));
}

Result<std::optional<Standing>> LoadStanding(Store& store, const EdgeId& id) {
  using Newest = std::optional<Standing>;
  return Load<Newest>(store, "standing of edge " + id.str(), [&]() -> Result<Newest> {
    Query query(
        store,
        "SELECT t.number, t.how, t.at_ns, t.who, t.reason FROM edge e JOIN standing t ON t.edge_number = e.number "
        "WHERE e.edge_id = ? ORDER BY t.number DESC LIMIT 1");
    return query.Bind(id).Step() ? Newest(StandingAt(query, 0)) : std::nullopt;
  });
}

Result<std::optional<Standing>> LoadStanding(Store& store, const RobotId& robot, const SensorId& sensor) {
  using Newest = std::optional<Standing>;
  return Load<Newest>(store, "standing of sensor " + sensor.str(), [&]() -> Result<Newest> {
    Query query(
        store,
        "SELECT number, how, at_ns, who, reason FROM standing WHERE robot_id = ? AND sensor_id = ? AND how <> 'epoch' "
        "ORDER BY number DESC LIMIT 1");
    return query.Bind(robot, sensor).Step() ? Newest(StandingAt(query, 0)) : std::nullopt;
  });
}

}  // namespace rigcal::storage
