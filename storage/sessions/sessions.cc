#include "storage/sessions/sessions.h"

#include <limits>
#include <set>

#include "server/formats/documents.h"
#include "storage/database/query.h"
#include "storage/sessions/standing.h"

namespace rigcal::storage {
namespace {

std::string Subject(const RobotId& robot) { return "sessions of robot " + robot.str(); }
std::string Subject(const SessionId& id) { return "session " + id.str(); }

// A closed session was given all its payloads: then they need not be counted, but for those that were lost since.
const std::string kSelectRow =
    "SELECT s.robot_id, s.session_id, s.payload_count, s.size_bytes, s.captured_ns, s.opened_ns, s.operator_name, "
    "c.closed_ns, CASE WHEN c.closed_ns IS NOT NULL THEN s.payload_count "
    "ELSE (SELECT count(*) FROM payload_held h WHERE h.session_number = s.number) END - "
    "(SELECT count(*) FROM waiting_blob w CROSS JOIN payload p ON p.digest = w.digest "
    "CROSS JOIN payload_held h ON h.session_number = p.session_number AND h.idx = p.idx "
    "WHERE p.session_number = s.number) "
    "FROM session s LEFT JOIN session_closed c ON c.session_number = s.number ";

SessionRow SessionRowOf(const Query& query) {
  SessionRow row;
  row.robot = query.IdAt<RobotId>(0);
  row.id = query.IdAt<SessionId>(1);
  row.payloads = query.Int(2);
  row.bytes = query.Int(3);
  row.captured_at = query.Time(4);
  row.opened_at = query.Time(5);
  row.operator_name = query.Text(6);
  row.closed = !query.IsNull(7);
  if (row.closed) row.closed_at = query.Time(7);
  row.payloads_held = query.Int(8);
  return row;
}

std::int64_t TotalBytes(const Manifest& manifest) {
  std::int64_t total = 0;
  for (const Payload& payload : manifest.payloads) total += payload.size_bytes;
  return total;
}

// Its number; nothing if the session is there already.
std::optional<std::int64_t> InsertSession(Store& store, const SessionId& id, const std::string& manifest_json,
                                          const Manifest& manifest, Stamp now) {
  const SessionHeader& header = manifest.header;
  Query insert(store,
               "INSERT INTO session (session_id, robot_id, captured_ns, opened_ns, operator_name, payload_count, "
               "size_bytes, manifest) VALUES (?, ?, ?, ?, ?, ?, ?, ?) ON CONFLICT DO NOTHING RETURNING number");
  insert.Bind(id, header.robot, header.captured_at, now, header.operator_name, manifest.payloads.size(),
              TotalBytes(manifest));
  return insert.BindNoCopy(manifest_json).RunForKey();
}

void InsertPayloads(Store& store, std::int64_t session_number, const std::vector<Payload>& payloads) {
  for (std::size_t i = 0; i < payloads.size(); ++i)
    Query(store, "INSERT INTO payload VALUES (?, ?, ?, ?, ?)")
        .Bind(session_number, i, payloads[i].path, payloads[i].digest, payloads[i].size_bytes)
        .Run();
}

// Which earlier sessions of its robot hold half or more of what they hold in common with the one that was opened last.
void InsertRepeats(Store& store, std::int64_t session_number) {
  Query(store,
        "INSERT INTO session_repeat SELECT old.robot_id, old.number, later.number FROM session later "
        "CROSS JOIN payload again ON again.session_number = later.number "
        "CROSS JOIN payload ON payload.digest = again.digest AND payload.session_number < later.number "
        "CROSS JOIN session old ON old.number = payload.session_number AND old.robot_id = later.robot_id "
        "WHERE later.number = ? GROUP BY old.number, later.number HAVING 2 * count(DISTINCT payload.idx) >= "
        "old.payload_count")
      .Bind(session_number)
      .Run();
}

void InsertBoards(Store& store, std::int64_t session_number) {
  Query(store,
        "INSERT INTO session_board SELECT number, json_extract(t.value, '$.id'), coalesce(json_extract(t.value, "
        "'$.serial'), ''), json_extract(t.value, '$.type'), "
        "CAST(coalesce(json_extract(t.value, '$.inner_corners[0]'), json_extract(t.value, '$.tags[0]'), "
        "json_extract(t.value, '$.circles[0]')) AS BIGINT), "
        "CAST(coalesce(json_extract(t.value, '$.inner_corners[1]'), json_extract(t.value, '$.tags[1]'), "
        "json_extract(t.value, '$.circles[1]')) AS BIGINT), "
        "CAST(json_extract(t.value, '$.square_size_m') AS DOUBLE PRECISION), "
        "coalesce(CAST(json_extract(t.value, '$.square_size_sigma_m') AS DOUBLE PRECISION), 0.0) "
        "FROM session, json_each(session.manifest, '$.targets') AS t WHERE number = ?")
      .Bind(session_number)
      .Run();
}

void InsertListed(Store& store, std::int64_t session_number) {
  Query(store,
        "INSERT INTO listed_sensor SELECT robot_id, json_extract(sensor.value, '$.id') FROM session, "
        "json_each(session.manifest, '$.sensors') AS sensor WHERE number = ? ON CONFLICT DO NOTHING")
      .Bind(session_number)
      .Run();
  Query(store,
        "INSERT INTO session_remount SELECT robot_id, number, sensor.value FROM session, "
        "json_each(session.manifest, '$.remounted') AS sensor WHERE number = ? ON CONFLICT DO NOTHING")
      .Bind(session_number)
      .Run();
  Query(store,
        "INSERT INTO sensor_part SELECT robot_id, json_extract(sensor.value, '$.id'), number, "
        "json_extract(sensor.value, '$.serial'), json_extract(sensor.value, '$.firmware') FROM session, "
        "json_each(session.manifest, '$.sensors') AS sensor WHERE number = ? AND "
        "coalesce(json_extract(sensor.value, '$.serial'), json_extract(sensor.value, '$.firmware')) IS NOT NULL ON "
        "CONFLICT DO NOTHING")
      .Bind(session_number)
      .Run();
  Query(store,
        "INSERT INTO session_model SELECT robot_id, captured_ns, number, json_extract(manifest, '$.rig_model') "
        "FROM session WHERE number = ? AND json_extract(manifest, '$.rig_model') <> ''")
      .Bind(session_number)
      .Run();
  Query(store,
        "INSERT INTO session_reference SELECT number, json_extract(manifest, '$.reference') FROM session "
        "WHERE number = ? AND json_extract(manifest, '$.reference') IS NOT NULL")
      .Bind(session_number)
      .Run();
  InsertBoards(store, session_number);
}

void QueueJob(Store& store, std::int64_t session_number, const RobotId& robot, const SensorPair& pair, Stamp now) {
  const auto number =
      Query(store,
            "INSERT INTO job (session_number, sensor_a, sensor_b, queued_ns) VALUES (?, ?, ?, ?) RETURNING number")
          .Bind(session_number, pair.a, pair.b, now)
          .RunForKey();
  Query(store, "INSERT INTO waiting_job VALUES (?, ?)").Bind(number, robot).Run();
}

// Each pair once, in the order given.
std::vector<SensorPair> Distinct(const std::vector<SensorPair>& pairs) {
  std::set<SensorPair> seen;
  std::vector<SensorPair> distinct;
  for (const SensorPair& pair : pairs)
    if (seen.insert(pair).second) distinct.push_back(pair);
  return distinct;
}

Status Close(Store& store, const SessionRow& row, const std::vector<SensorPair>& pairs, Stamp now) {
  if (row.payloads_held < row.payloads)
    return Fail(ErrorCode::kConflict,
                Subject(row.id) + " holds " + std::to_string(row.payloads_held) + " of " +
                    std::to_string(row.payloads) + " payloads",
                "Send the missing ones: push the folder again.");
  const std::int64_t session_number =
      Query(store,
            "INSERT INTO session_closed SELECT number, ? FROM session WHERE session_id = ? RETURNING session_number")
          .Bind(now, row.id)
          .RunForKey()
          .value();
  InsertListed(store, session_number);
  for (const SensorPair& pair : Distinct(pairs)) QueueJob(store, session_number, row.robot, pair, now);
  RIGCAL_TRY(AppendPushed(store, row.robot, row.id, now));
  return KeepSuperseding(store, row.robot, row.id, now);
}

}  // namespace

Status AppendSession(Store& store, const SessionId& id, const std::string& manifest_json, const Manifest& manifest,
                     Stamp now) {
  return store.connection().Append(Subject(id), [&]() -> Status {
    RIGCAL_TRY(AppendRobot(store, manifest.header.robot, now));
    const auto session_number = InsertSession(store, id, manifest_json, manifest, now);
    if (!session_number) return {};
    InsertPayloads(store, *session_number, manifest.payloads);
    InsertRepeats(store, *session_number);
    return {};
  });
}

Result<std::optional<SessionRow>> LoadSession(Store& store, const SessionId& id) {
  return Load<std::optional<SessionRow>>(store, Subject(id), [&]() -> Result<std::optional<SessionRow>> {
    Query query(store, kSelectRow + "WHERE s.session_id = ?");
    if (!query.Bind(id).Step()) return std::nullopt;
    return SessionRowOf(query);
  });
}

Result<std::optional<Manifest>> LoadManifest(Store& store, const SessionId& id) {
  return Load<std::optional<Manifest>>(store, Subject(id), [&]() -> Result<std::optional<Manifest>> {
    Query query(store, "SELECT manifest FROM session WHERE session_id = ?");
    if (!query.Bind(id).Step()) return std::nullopt;
    RIGCAL_ASSIGN(Manifest manifest, formats::ReadManifest(query.Text(0)));
    return manifest;
  });
}

namespace {

struct SessionPlace {
  std::int64_t captured_ns = std::numeric_limits<std::int64_t>::max(),
               number = std::numeric_limits<std::int64_t>::max();
};

// In lists, the newest first; of an empty id: before all.
Result<SessionPlace> PlaceOf(Store& store, const SessionId& id) {
  if (id.empty()) return SessionPlace{};
  Query query(store, "SELECT captured_ns, number FROM session WHERE session_id = ?");
  if (query.Bind(id).Step()) return SessionPlace{query.Int(0), query.Int(1)};
  return Fail(ErrorCode::kNotFound, Subject(id) + " is not known", "`rigcal sessions --json` lists those that are.");
}

}  // namespace

Result<std::vector<SessionRow>> LoadSessions(Store& store, const RobotId& robot, const SessionId& before,
                                             std::int64_t limit) {
  return Load<std::vector<SessionRow>>(store, "list of sessions", [&]() -> Result<std::vector<SessionRow>> {
    RIGCAL_ASSIGN(const SessionPlace place, PlaceOf(store, before));
    Query query(store, kSelectRow + "WHERE (s.captured_ns, s.number) < (?, ?) " +
                           (robot.empty() ? "" : "AND s.robot_id = ?4 ") +
                           "ORDER BY s.captured_ns DESC, s.number DESC LIMIT ?3");
    query.Bind(place.captured_ns, place.number, limit);
    if (!robot.empty()) query.Bind(robot);
    std::vector<SessionRow> rows;
    while (query.Step()) rows.push_back(SessionRowOf(query));
    return rows;
  });
}

Result<std::vector<SessionRow>> LoadOpenSessions(Store& store, const RobotId& robot) {
  return Load<std::vector<SessionRow>>(store, Subject(robot), [&]() -> Result<std::vector<SessionRow>> {
    Query query(
        store,
        kSelectRow +
            "WHERE s.robot_id = ?1 AND (c.closed_ns IS NULL OR s.number IN (SELECT j.session_number FROM waiting_job w "
            "CROSS JOIN job j ON j.number = w.job_number WHERE w.robot_id = ?1)) "
            "ORDER BY s.captured_ns DESC, s.number DESC");
    query.Bind(robot);
    std::vector<SessionRow> rows;
    while (query.Step()) rows.push_back(SessionRowOf(query));
    return rows;
  });
}

Result<std::map<SessionId, Stamp>> LoadCapturedAt(Store& store, const RobotId& robot) {
  using Stamps = std::map<SessionId, Stamp>;
  return Load<Stamps>(store, Subject(robot), [&]() -> Result<Stamps> {
    Query query(store, "SELECT session_id, captured_ns FROM session WHERE robot_id = ?");
    query.Bind(robot);
    Stamps stamps;
    while (query.Step()) stamps.emplace(query.IdAt<SessionId>(0), query.Time(1));
    return stamps;
  });
}

Result<std::map<SessionId, Stamp>> LoadCapturedAt(Store& store, const std::vector<SessionId>& sessions) {
  using Stamps = std::map<SessionId, Stamp>;
  return Load<Stamps>(store, "times of sessions", [&]() -> Result<Stamps> {
    Query query(store,
                "SELECT session_id, captured_ns FROM session WHERE session_id IN (SELECT value FROM json_each(?))");
    query.Bind(ListOf(sessions));
    Stamps stamps;
    while (query.Step()) stamps.emplace(query.IdAt<SessionId>(0), query.Time(1));
    return stamps;
  });
}

Result<SensorId> LoadNamedReference(Store& store, const RobotId& robot, const std::vector<SensorId>& gone) {
  return Load<SensorId>(store, Subject(robot), [&]() -> Result<SensorId> {
    Query query(store,
                "SELECT r.sensor_id FROM session s CROSS JOIN session_reference r ON r.session_number = s.number "
                "WHERE s.robot_id = ? AND r.sensor_id NOT IN (SELECT value FROM json_each(?)) "
                "ORDER BY s.captured_ns, s.session_id LIMIT 1");
    return query.Bind(robot, ListOf(gone)).Step() ? query.IdAt<SensorId>(0) : SensorId();
  });
}

Result<std::optional<NewestCapture>> LoadNewestCapture(Store& store, const RobotId& robot) {
  using Newest = std::optional<NewestCapture>;
  return Load<Newest>(store, Subject(robot), [&]() -> Result<Newest> {
    Query query(store,
                "SELECT captured_ns, operator_name FROM session JOIN session_closed ON session_number = number "
                "WHERE robot_id = ? ORDER BY captured_ns DESC, number DESC LIMIT 1");
    return query.Bind(robot).Step() ? Newest({query.Time(0), query.Text(1)}) : std::nullopt;
  });
}

Status CloseSession(Store& store, const SessionId& id, const std::vector<SensorPair>& pairs, Stamp now) {
  return store.connection().Append(Subject(id), [&]() -> Status {
    RIGCAL_ASSIGN(const std::optional<SessionRow> row, LoadSession(store, id));
    if (!row) return Fail(ErrorCode::kNotFound, Subject(id) + " is not known", "Push the session folder.");
    return row->closed ? Status{} : Close(store, *row, pairs, now);
  });
}

Result<std::vector<SensorId>> LoadListedSensors(Store& store, const RobotId& robot) {
  return Load<std::vector<SensorId>>(store, Subject(robot), [&]() -> Result<std::vector<SensorId>> {
    Query query(store, "SELECT sensor_id FROM listed_sensor WHERE robot_id = ? ORDER BY sensor_id");
    query.Bind(robot);
    std::vector<SensorId> sensors;
    while (query.Step()) sensors.push_back(query.IdAt<SensorId>(0));
    return sensors;
  });
}

}  // namespace rigcal::storage
