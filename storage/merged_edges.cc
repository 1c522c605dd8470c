#include "storage/merged_edges.h"

#include <map>
#include <tuple>

#include "storage/query.h"

namespace rigcal::storage {
namespace {

std::string Subject(const RobotId& robot) { return "merged edges of robot " + robot.str(); }

Blob BlobOfVectors(const std::vector<Vector6d>& vectors) {
  std::vector<double> values;
  for (const Vector6d& one : vectors) values.insert(values.end(), one.data(), one.data() + 6);
  return BlobOf(values.data(), values.size());
}

void Insert(Store& store, const RevisionKey& key, const MergedEdge& merged) {
  Query insert(store, "INSERT INTO merged_edge VALUES (?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?)");
  insert.Bind(key.robot, key.number, merged.frame_a, merged.frame_b, merged.method, merged.count, merged.newest);
  insert.Bind(merged.T_a_b.p_m.x(), merged.T_a_b.p_m.y(), merged.T_a_b.p_m.z());
  insert.Bind(merged.T_a_b.q.x(), merged.T_a_b.q.y(), merged.T_a_b.q.z(), merged.T_a_b.q.w());
  insert.Bind(NameOf(merged.source), merged.dof, merged.by_blocks);
  insert.Bind(BlobOf(merged.Omega), BlobOf(merged.scatter), BlobOf(merged.given)).Run();
  for (const auto& [name, scores] : merged.constants)
    Query(store, "INSERT INTO merged_edge_constant VALUES (?, ?, ?, ?, ?, ?, ?)")
        .Bind(key.robot, key.number, merged.frame_a, merged.frame_b, merged.method, name, BlobOfVectors(scores))
        .Run();
}

Result<MergedEdge> MergedAt(const Query& row) {
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
  merged.Omega = row.MatrixAt(15), merged.scatter = row.MatrixAt(16), merged.given = row.MatrixAt(17);
  return merged;
}

const std::string kOfRevision =
    " WHERE robot_id = ?1 AND revision_number = CASE ?2 WHEN 0 THEN (SELECT max(number) FROM revision WHERE robot_id = ?1) ELSE ?2 END";

}  // namespace

Result<std::vector<MergedEdge>> LoadMergedEdges(Store& store, const RobotId& robot, int number) {
  using Edges = std::vector<MergedEdge>;
  return Load<Edges>(store, Subject(robot), [&]() -> Result<Edges> {
    std::map<std::tuple<SensorId, SensorId, std::string>, MergedEdge> merged;
    Query rows(store,
               "SELECT frame_a, frame_b, method, edges, newest_ns, T_a_b_x_m, T_a_b_y_m, T_a_b_z_m, T_a_b_qx, T_a_b_qy, T_a_b_qz, "
               "T_a_b_qw, source, dof, by_blocks, information, scatter, given FROM merged_edge" + kOfRevision);
    rows.Bind(robot, number);
    while (rows.Step()) {
      RIGCAL_ASSIGN(MergedEdge one, MergedAt(rows));
      merged[{one.frame_a, one.frame_b, one.method}] = std::move(one);
    }
    Query constants(store, "SELECT frame_a, frame_b, method, name, scores FROM merged_edge_constant" + kOfRevision);
    constants.Bind(robot, number);
    while (constants.Step()) {
      auto& scores =
          merged[{constants.IdAt<SensorId>(0), constants.IdAt<SensorId>(1), constants.Text(2)}].constants[constants.Text(3)];
      const std::vector<double> values = constants.Doubles(4);
      for (std::size_t i = 0; i + 6 <= values.size(); i += 6) scores.emplace_back(values.data() + i);
    }
    Edges all;
    for (auto& [key, one] : merged) all.push_back(std::move(one));
    return all;
  });
}

Result<bool> IsMergeOutdated(Store& store, const RobotId& robot) {
  return Load<bool>(store, Subject(robot), [&]() -> Result<bool> {
    Query query(store,
                "SELECT 1 FROM standing t JOIN counted_edge c ON c.edge_number = t.edge_number WHERE t.robot_id = ? AND NOT EXISTS "
                "(SELECT 1 FROM waiting_merge w WHERE w.robot_id = t.robot_id AND w.edge_number = t.edge_number) LIMIT 1");
    return query.Bind(robot).Step();
  });
}

Status AppendMergedEdges(Store& store, const RevisionKey& key, const std::vector<MergedEdge>& merged,
                         const std::vector<EdgeId>& taken, const std::vector<EdgeId>& back) {
  return store.connection().Append(Subject(key.robot), [&]() -> Status {
    for (const MergedEdge& one : merged) Insert(store, key, one);
    if (!back.empty())
      Query(store, "INSERT OR IGNORE INTO waiting_merge SELECT ?, number FROM edge WHERE edge_id IN (SELECT value FROM json_each(?))")
          .Bind(key.robot, ListOf(back))
          .Run();
    if (!taken.empty())
      Query(store,
            "DELETE FROM waiting_merge WHERE robot_id = ? AND edge_number IN "
            "(SELECT number FROM edge WHERE edge_id IN (SELECT value FROM json_each(?)))")
          .Bind(key.robot, ListOf(taken))
          .Run();
    return {};
  });
}

}  // namespace rigcal::storage
