#include "storage/revisions/merged_edges.h"

#include <map>
#include <tuple>

#include "server/base/digests/sha256.h"
#include "storage/database/query.h"
#include "storage/sessions/epochs.h"
#include "storage/sessions/retired.h"
#include "storage/sessions/standing.h"

namespace rigcal::storage {
namespace {

std::string Subject(const RobotId& robot) { return "merged edges of robot " + robot.str(); }

Blob BlobOfVectors(const std::vector<Vector6d>& vectors) {
  std::vector<double> values;
  for (const Vector6d& one : vectors) values.insert(values.end(), one.data(), one.data() + 6);
  return BlobOf(values.data(), values.size());
}

// Those that contradict the first of their pair stand in tables of their own, with their part in the place of
// of_sessions.
std::string TableOf(bool apart) { return apart ? "merged_edge_apart" : "merged_edge"; }

void Insert(Store& store, const RevisionKey& key, const MergedEdge& merged) {
  const std::string table = TableOf(merged.part > 0);
  const int kind = merged.part > 0 ? merged.part : merged.of_sessions ? 1 : 0;
  Query insert(store,
               "INSERT INTO " + table + " VALUES (?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?)");
  insert.Bind(key.robot, key.number, merged.frame_a, merged.frame_b, merged.method, kind);
  insert.Bind(merged.count, merged.newest, merged.T_a_b.p_m.x(), merged.T_a_b.p_m.y(), merged.T_a_b.p_m.z());
  insert.Bind(merged.T_a_b.q.x(), merged.T_a_b.q.y(), merged.T_a_b.q.z(), merged.T_a_b.q.w());
  insert.Bind(NameOf(merged.source), merged.dof, merged.by_blocks);
  insert.Bind(BlobOf(merged.Omega), BlobOf(merged.scatter), BlobOf(merged.given));
  insert.Bind(merged.visits.isZero(0.0) ? std::nullopt : std::optional(BlobOf(merged.visits))).Run();
  if (merged.weak)
    Query(store, "INSERT INTO merged_edge_weak VALUES (?, ?, ?, ?, ?)")
        .Bind(key.robot, key.number, merged.frame_a, merged.frame_b, merged.method)
        .Run();
  for (const auto& [name, scores] : merged.constants)
    Query(store, "INSERT INTO " + table + "_constant VALUES (?, ?, ?, ?, ?, ?, ?, ?)")
        .Bind(key.robot, key.number, merged.frame_a, merged.frame_b, merged.method, kind, name, BlobOfVectors(scores))
        .Run();
}

void ReplaceScores(Store& store, const RobotId& robot, const std::vector<MergedEdge>& merged) {
  Query(store, "DELETE FROM merge_state_scores WHERE robot_id = ?").Bind(robot).Run();
  for (const MergedEdge& one : merged)
    if (one.of_sessions)
      Query(store, "INSERT INTO merge_state_scores VALUES (?, ?, ?, ?, ?)")
          .Bind(robot, one.frame_a, one.frame_b, one.method,
                BlobOf(one.scores.data(), static_cast<std::size_t>(one.scores.size())))
          .Run();
}

void ReplaceIds(Store& store, const RobotId& robot, const std::vector<EdgeId>& ids) {
  Query(store, "DELETE FROM merge_state_edge WHERE robot_id = ?").Bind(robot).Run();
  Query(store, "INSERT INTO merge_state_edge SELECT value, ? FROM json_each(?) WHERE true ON CONFLICT DO NOTHING")
      .Bind(robot, ListOf(ids))
      .Run();
}

Result<MergedEdge> MergedAt(const Query& row, bool apart) {
  MergedEdge merged;
  merged.frame_a = row.IdAt<SensorId>(0), merged.frame_b = row.IdAt<SensorId>(1);
  merged.method = row.Text(2);
  merged.count = static_cast<int>(row.Int(3));
  merged.newest = row.Time(4);
  merged.T_a_b.p_m = {row.Real(5), row.Real(6), row.Real(7)};
  merged.T_a_b.q.coeffs() << row.Real(8), row.Real(9), row.Real(10), row.Real(11);
  RIGCAL_ASSIGN(merged.source, UncertaintySourceOf(row.Text(12)));
  merged.dof = static_cast<int>(row.Int(13));
  merged.by_blocks = row.Int(14) != 0;
  merged.of_sessions = !apart && row.Int(18) != 0;
  merged.part = apart ? static_cast<int>(row.Int(18)) : 0;
  merged.Omega = row.MatrixAt(15), merged.scatter = row.MatrixAt(16), merged.given = row.MatrixAt(17);
  if (!row.IsNull(19)) merged.visits = row.MatrixAt(19);
  return merged;
}

const std::string kOfRevision =
    " WHERE robot_id = ?1 AND revision_number = CASE ?2 WHEN 0 THEN (SELECT max(number) FROM revision WHERE robot_id = "
    "?1) ELSE ?2 END";

// The last is of_sessions, or the part.
using Merged = std::map<std::tuple<SensorId, SensorId, std::string, std::int64_t>, MergedEdge>;

void LoadConstants(Store& store, const RobotId& robot, int number, bool apart, Merged& merged) {
  Query constants(store, std::string("SELECT frame_a, frame_b, method, ") + (apart ? "part" : "of_sessions") +
                             ", name, scores FROM " + TableOf(apart) + "_constant" + kOfRevision);
  constants.Bind(robot, number);
  while (constants.Step()) {
    auto& scores =
        merged[{constants.IdAt<SensorId>(0), constants.IdAt<SensorId>(1), constants.Text(2), constants.Int(3)}]
            .constants[constants.Text(4)];
    const std::vector<double> values = constants.Doubles(5);
    for (std::size_t i = 0; i + 6 <= values.size(); i += 6) scores.emplace_back(values.data() + i);
  }
}

void LoadWeak(Store& store, const RobotId& robot, int number, Merged& merged) {
  Query weak(store, "SELECT frame_a, frame_b, method FROM merged_edge_weak" + kOfRevision);
  weak.Bind(robot, number);
  while (weak.Step()) {
    const auto found = merged.find({weak.IdAt<SensorId>(0), weak.IdAt<SensorId>(1), weak.Text(2), 1});
    if (found != merged.end()) found->second.weak = true;
  }
}

Result<Merged> LoadMerged(Store& store, const RobotId& robot, int number, bool apart) {
  Merged merged;
  Query rows(store,
             "SELECT frame_a, frame_b, method, edges, newest_ns, T_a_b_x_m, T_a_b_y_m, T_a_b_z_m, T_a_b_qx, T_a_b_qy, "
             "T_a_b_qz, T_a_b_qw, source, dof, by_blocks, information, scatter, given, " +
                 std::string(apart ? "part" : "of_sessions") + ", visits FROM " + TableOf(apart) + kOfRevision);
  rows.Bind(robot, number);
  while (rows.Step()) {
    RIGCAL_ASSIGN(MergedEdge one, MergedAt(rows, apart));
    merged[{one.frame_a, one.frame_b, one.method, rows.Int(18)}] = std::move(one);
  }
  LoadConstants(store, robot, number, apart, merged);
  if (!apart) LoadWeak(store, robot, number, merged);
  return merged;
}

bool IsNewest(Store& store, const RobotId& robot, int number) {
  Query query(store, "SELECT max(number) FROM revision WHERE robot_id = ?");
  return number == 0 || (query.Bind(robot).Step() && query.Int(0) == number);
}

void LoadScores(Store& store, const RobotId& robot, Merged& merged) {
  Query rows(store, "SELECT frame_a, frame_b, method, scores FROM merge_state_scores WHERE robot_id = ?");
  rows.Bind(robot);
  while (rows.Step()) {
    const auto found = merged.find({rows.IdAt<SensorId>(0), rows.IdAt<SensorId>(1), rows.Text(2), 1});
    if (found == merged.end()) continue;
    const std::vector<double> values = rows.Doubles(3);
    found->second.scores = Eigen::Map<const Eigen::Matrix<double, 6, Eigen::Dynamic>>(
        values.data(), 6, static_cast<Eigen::Index>(values.size() / 6));
  }
}

// Of `ids`, those that an edge has which is in no window; `column` is the edge's.
std::string OutsideOf(Store& store, const RobotId& robot, const std::string& column, const std::string& ids) {
  Query query(store,
              "SELECT value FROM json_each(?) WHERE EXISTS (SELECT 1 FROM edge e JOIN counted_edge c ON c.edge_number "
              "= e.number "
              "WHERE e." +
                  column +
                  " = value AND NOT EXISTS (SELECT 1 FROM waiting_merge w WHERE w.robot_id = ? "
                  "AND w.edge_number = e.number)) ORDER BY value");
  query.Bind(ids, robot);
  std::string outside;
  while (query.Step()) outside += query.Text(0) + "\n";
  return outside;
}

template <typename Map>
std::string KeysOf(const Map& map) {
  std::vector<typename Map::key_type> keys;
  for (const auto& [key, value] : map) keys.push_back(key);
  return ListOf(keys);
}

// Of edges that have a date, those of sessions and some pushed ones, whether any is in no window.
bool AnyDatedOutside(Store& store, const RobotId& robot) {
  return Query(store,
               "SELECT 1 FROM counted_edge c JOIN edge e ON e.number = c.edge_number WHERE c.robot_id = ?1 AND "
               "(e.session_id IS NOT NULL OR e.measured_ns IS NOT NULL) AND NOT EXISTS (SELECT 1 FROM waiting_merge w "
               "WHERE w.robot_id = ?1 AND "
               "w.edge_number = c.edge_number) LIMIT 1")
      .Bind(robot)
      .Step();
}

// Of retired sensors, those of which an edge is in no window.
std::string SensorsOutside(Store& store, const RobotId& robot, const WhatCounts& counts) {
  std::string outside;
  for (const auto& [sensor, standing] : counts.retired_sensors)
    if (Query(store,
              "SELECT 1 FROM counted_edge c JOIN edge e ON e.number = c.edge_number WHERE c.robot_id = ?1 AND "
              "?2 IN (e.frame_a, e.frame_b) AND NOT EXISTS (SELECT 1 FROM waiting_merge w WHERE w.robot_id = ?1 AND "
              "w.edge_number = c.edge_number) LIMIT 1")
            .Bind(robot, sensor)
            .Step())
      outside += "sensor " + sensor.str() + "\n";
  return outside;
}

std::string RetiredSessionsOutside(Store& store, const RobotId& robot, const WhatCounts& counts) {
  const std::string outside = OutsideOf(store, robot, "session_id", KeysOf(counts.retired_sessions));
  return outside.empty() ? "" : "retired\n" + outside;
}

bool AnyOutside(Store& store, const RobotId& robot) {
  return Query(store,
               "SELECT 1 FROM counted_edge c WHERE c.robot_id = ?1 AND NOT EXISTS (SELECT 1 FROM waiting_merge w WHERE "
               "w.robot_id = ?1 AND w.edge_number = c.edge_number) LIMIT 1")
      .Bind(robot)
      .Step();
}

// What a session says concerns edges that have a date; what a person says also those that were stored before.
std::string EpochsOutside(Store& store, const RobotId& robot, const std::vector<Epoch>& epochs) {
  if (epochs.empty() || !AnyOutside(store, robot)) return "";
  const bool any_dated = AnyDatedOutside(store, robot);
  std::string outside;
  for (const Epoch& epoch : epochs) {
    const bool by_person = epoch.cause == EpochCause::kPerson;
    const std::string since = by_person ? "since " + std::to_string(epoch.begins_at.ns) : epoch.session.str();
    if (by_person || any_dated) outside += since + " " + epoch.sensor.str() + "\n";
  }
  return outside;
}

// Of what people said, what concerns edges that are in no window. Empty where nothing does.
std::string BasisOf(Store& store, const RobotId& robot, const WhatCounts& counts) {
  std::string basis = OutsideOf(store, robot, "session_id", KeysOf(counts.superseded)) +
                      OutsideOf(store, robot, "edge_id", KeysOf(counts.retired)) +
                      RetiredSessionsOutside(store, robot, counts) + SensorsOutside(store, robot, counts);
  basis += EpochsOutside(store, robot, counts.epochs);
  return basis.empty() ? "" : Sha256Of(basis).str();
}

std::string StoredBasis(Store& store, const RobotId& robot) {
  Query query(store, "SELECT digest FROM merge_basis WHERE robot_id = ? ORDER BY revision_number DESC LIMIT 1");
  return query.Bind(robot).Step() ? query.Text(0) : std::string();
}

void PutBack(Store& store, const RobotId& robot, const std::vector<EdgeId>& edges) {
  Query(store,
        "INSERT INTO waiting_merge SELECT ?, number FROM edge WHERE edge_id IN (SELECT value FROM json_each(?)) ON "
        "CONFLICT DO NOTHING")
      .Bind(robot, ListOf(edges))
      .Run();
}

void TakeOut(Store& store, const RobotId& robot, const std::vector<EdgeId>& edges) {
  Query(store,
        "DELETE FROM waiting_merge WHERE robot_id = ? AND edge_number IN "
        "(SELECT number FROM edge WHERE edge_id IN (SELECT value FROM json_each(?)))")
      .Bind(robot, ListOf(edges))
      .Run();
}

void KeepHow(Store& store, const RobotId& robot, const MergeStep& step) {
  Query(store,
        "INSERT INTO merge_state_window VALUES (?, ?) ON CONFLICT (robot_id) DO UPDATE SET visits_in_full = "
        "excluded.visits_in_full")
      .Bind(robot, step.visits_in_full)
      .Run();
  if (step.anew || step.never_anew) Query(store, "DELETE FROM waiting_merge_anew WHERE robot_id = ?").Bind(robot).Run();
}

}  // namespace

Result<std::vector<MergedEdge>> LoadMergedEdges(Store& store, const RobotId& robot, int number) {
  using Edges = std::vector<MergedEdge>;
  return Load<Edges>(store, Subject(robot), [&]() -> Result<Edges> {
    RIGCAL_ASSIGN(Merged merged, LoadMerged(store, robot, number, false));
    if (IsNewest(store, robot, number)) LoadScores(store, robot, merged);
    RIGCAL_ASSIGN(Merged apart, LoadMerged(store, robot, number, true));
    Edges all;
    for (Merged* some : {&merged, &apart})
      for (auto& [key, one] : *some) all.push_back(std::move(one));
    return all;
  });
}

Result<std::optional<RobotId>> FindRobotOfMerged(Store& store, const EdgeId& id) {
  using Found = std::optional<RobotId>;
  return Load<Found>(store, "merged edge " + id.str(), [&]() -> Result<Found> {
    Query query(store, "SELECT robot_id FROM merge_state_edge WHERE edge_id = ?");
    return query.Bind(id).Step() ? Found(query.IdAt<RobotId>(0)) : std::nullopt;
  });
}

Result<std::vector<EdgeId>> FindMergedEdges(Store& store, const std::string& prefix, const RobotId& robot) {
  return Load<std::vector<EdgeId>>(store, "merged edge " + prefix, [&]() -> Result<std::vector<EdgeId>> {
    Query query(store,
                "SELECT edge_id FROM merge_state_edge WHERE edge_id >= ?1 AND edge_id < ?2 AND (robot_id = ?3 OR ?3 = "
                "'') ORDER BY edge_id");
    query.Bind(prefix, prefix + "g", robot);
    std::vector<EdgeId> ids;
    while (query.Step()) ids.push_back(query.IdAt<EdgeId>(0));
    return ids;
  });
}

Result<std::vector<EdgeId>> LoadIdsWithin(Store& store, const RobotId& robot, const MergedEdge& merged) {
  return Load<std::vector<EdgeId>>(store, Subject(robot), [&]() -> Result<std::vector<EdgeId>> {
    Query query(store,
                "SELECT e.edge_id FROM counted_edge c CROSS JOIN edge e ON e.number = c.edge_number WHERE c.robot_id = "
                "?1 AND e.frame_a = ?2 AND e.frame_b = ?3 AND e.method = ?4 AND e.state = 'good' AND (e.session_id IS "
                "NOT NULL) = (?5 <> 0) AND NOT EXISTS (SELECT 1 FROM waiting_merge w WHERE w.robot_id = c.robot_id AND "
                "w.edge_number = c.edge_number) ORDER BY e.edge_id");
    query.Bind(robot, merged.frame_a, merged.frame_b, merged.method, merged.of_sessions ? 1 : 0);
    std::vector<EdgeId> ids;
    while (query.Step()) ids.push_back(query.IdAt<EdgeId>(0));
    return ids;
  });
}

Result<WhatCounts> LoadWhatCounts(Store& store, const RobotId& robot) {
  WhatCounts counts;
  RIGCAL_ASSIGN(counts.superseded, LoadSuperseded(store, robot));
  RIGCAL_ASSIGN(counts.retired, LoadRetired(store, robot));
  RIGCAL_ASSIGN(counts.epochs, LoadEpochs(store, robot));
  RIGCAL_ASSIGN(counts.retired_sessions, LoadRetiredSessions(store, robot));
  RIGCAL_ASSIGN(counts.retired_sensors, LoadRetiredSensors(store, robot));
  return counts;
}

Result<bool> IsMergeOutdated(Store& store, const RobotId& robot, const WhatCounts& counts) {
  return Load<bool>(store, Subject(robot),
                    [&]() -> Result<bool> { return BasisOf(store, robot, counts) != StoredBasis(store, robot); });
}

Result<bool> IsToMergeAnew(Store& store, const RobotId& robot, std::int64_t visits_in_full) {
  return Load<bool>(store, Subject(robot), [&]() -> Result<bool> {
    if (Query(store, "SELECT 1 FROM waiting_merge_anew WHERE robot_id = ?").Bind(robot).Step()) return true;
    Query window(store, "SELECT visits_in_full FROM merge_state_window WHERE robot_id = ?");
    return visits_in_full > (window.Bind(robot).Step() ? window.Int(0) : kDefaultVisitsInFull);
  });
}

Result<std::int64_t> CountToMergeAnew(Store& store) {
  return Load<std::int64_t>(store, "robots to merge anew", [&]() -> Result<std::int64_t> {
    Query query(store, "SELECT count(*) FROM waiting_merge_anew");
    return query.Step() ? query.Int(0) : 0;
  });
}

Status AppendMergedEdges(Store& store, const RevisionKey& key, const MergeStep& step, const WhatCounts& counts) {
  return store.connection().Append(Subject(key.robot), [&]() -> Status {
    for (const MergedEdge& one : step.merged) Insert(store, key, one);
    ReplaceScores(store, key.robot, step.merged);
    ReplaceIds(store, key.robot, step.ids);
    KeepHow(store, key.robot, step);
    if (!step.back.empty()) PutBack(store, key.robot, step.back);
    if (!step.taken.empty()) TakeOut(store, key.robot, step.taken);
    const std::string basis = BasisOf(store, key.robot, counts);
    if (basis != StoredBasis(store, key.robot))
      Query(store, "INSERT INTO merge_basis VALUES (?, ?, ?)").Bind(key.robot, key.number, basis).Run();
    return {};
  });
}

}  // namespace rigcal::storage
