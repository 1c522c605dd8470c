#include <limits>
#include <sstream>
#include <unordered_map>

#include "storage/database/query.h"
#include "storage/edges/edges.h"

namespace rigcal::storage {
namespace {

// Which of the edges that count: `where` has one parameter, `key`.
struct Selection {
  std::string where;
  std::string key;
  bool blocks = true;
};

struct Selected {
  std::vector<Edge> edges;
  std::unordered_map<std::int64_t, std::size_t> position;  // of a row number in `edges`
};

Se3 PoseOf(const Query& query, int column) {
  Se3 T_a_b;
  T_a_b.p_m = {query.Real(column), query.Real(column + 1), query.Real(column + 2)};
  T_a_b.q.coeffs() << query.Real(column + 3), query.Real(column + 4), query.Real(column + 5), query.Real(column + 6);
  return T_a_b;
}

UncertaintySource SourceOf(const std::string& name) {
  Result<UncertaintySource> source = UncertaintySourceOf(name);
  if (!source) throw StoredWrong("a stored uncertainty has the unknown source " + name);
  return *source;
}

Uncertainty UncertaintyOf(const Query& query, int column) {
  Uncertainty uncertainty;
  uncertainty.Omega = query.MatrixAt(column);
  uncertainty.rank = static_cast<int>(query.Int(column + 1));
  uncertainty.dof = static_cast<int>(query.Int(column + 2));
  uncertainty.source = SourceOf(query.Text(column + 3));
  uncertainty.covariance = query.MatrixAt(column + 4);
  const std::vector<double> basis = query.Doubles(column + 5);
  const Eigen::Index directions = static_cast<Eigen::Index>(basis.size() / 6);
  uncertainty.unobservable_basis =
      Eigen::Map<const Eigen::Matrix<double, 6, Eigen::Dynamic>>(basis.data(), 6, directions);
  uncertainty.jackknife_ratio = query.Real(column + 6);  // NULL reads as 0
  return uncertainty;
}

Edge EdgeOf(const Query& query) {
  Edge edge;
  edge.id = query.IdAt<EdgeId>(1);
  edge.robot = query.IdAt<RobotId>(2);
  edge.session = query.IdAt<SessionId>(3);  // NULL reads as empty
  edge.epoch = static_cast<int>(query.Int(4));
  edge.frame_a = query.IdAt<SensorId>(5);
  edge.frame_b = query.IdAt<SensorId>(6);
  edge.method = query.Text(7);
  edge.state = query.Text(8) == "good" ? EdgeState::kGood : EdgeState::kFailed;
  if (!query.IsNull(23)) edge.measured_at = query.Time(23);
  if (edge.state != EdgeState::kGood) return edge;
  edge.T_a_b = PoseOf(query, 9);
  edge.uncertainty = UncertaintyOf(query, 16);
  return edge;
}

Selected LoadRows(Store& store, const Selection& selection) {
  Query query(store,
              "SELECT number, edge_id, robot_id, session_id, epoch, frame_a, frame_b, method, state, "
              "T_a_b_x_m, T_a_b_y_m, T_a_b_z_m, T_a_b_qx, T_a_b_qy, T_a_b_qz, T_a_b_qw, "
              "information, rank, dof, source, covariance, unobservable_basis, jackknife_ratio, measured_ns FROM edge "
              "e WHERE " +
                  selection.where +
                  " AND EXISTS (SELECT 1 FROM counted_edge c WHERE c.edge_number = e.number) ORDER BY edge_id");
  query.Bind(selection.key);
  Selected selected;
  while (query.Step()) {
    selected.position.emplace(query.Int(0), selected.edges.size());
    selected.edges.push_back(EdgeOf(query));
  }
  return selected;
}

// Calls take(edge, row) for each row of `table` that belongs to the selection, in order; columns count from 1.
template <typename Take>
void ForEachPart(Store& store, const Selection& selection, Selected& selected, const std::string& table,
                 const std::string& columns, const std::string& order, const Take& take) {
  Query query(store, "SELECT p.edge_number, " + columns + " FROM edge e CROSS JOIN " + table +
                         " p ON p.edge_number = e.number WHERE " + selection.where + " ORDER BY e.number, p." + order);
  query.Bind(selection.key);
  while (query.Step()) {
    const auto place = selected.position.find(query.Int(0));
    if (place != selected.position.end()) take(selected.edges[place->second], query);
  }
}

std::vector<Vector6d> VectorsAt(const Query& row, int column) {
  std::vector<Vector6d> vectors;
  const std::vector<double> values = row.Doubles(column);
  for (std::size_t i = 0; i + 6 <= values.size(); i += 6) vectors.emplace_back(values.data() + i);
  return vectors;
}

std::vector<BlockVector> BlocksAt(const Query& row, int ids_column, int d_column) {
  std::vector<BlockVector> blocks;
  std::istringstream ids(row.Text(ids_column));
  std::string id;
  for (const Vector6d& d : VectorsAt(row, d_column)) {
    if (!std::getline(ids, id)) throw StoredWrong("a stored block vector has no id");
    blocks.push_back({id, d});
  }
  return blocks;
}

// Edges from before version 39 have a row a block.
void LoadBlocks(Store& store, const Selection& selection, Selected& selected) {
  ForEachPart(store, selection, selected, "edge_blocks", "block_ids, p.d", "edge_number",
              [](Edge& edge, const Query& row) { edge.uncertainty.blocks = BlocksAt(row, 1, 2); });
  ForEachPart(store, selection, selected, "edge_block", "block_id, d_x_m, d_y_m, d_z_m, d_rx_rad, d_ry_rad, d_rz_rad",
              "idx", [](Edge& edge, const Query& row) {
                BlockVector block{row.Text(1), Vector6d::Zero()};
                block.d(tangent::kX) = row.Real(2);
                block.d(tangent::kY) = row.Real(3);
                block.d(tangent::kZ) = row.Real(4);
                block.d(tangent::kRx) = row.Real(5);
                block.d(tangent::kRy) = row.Real(6);
                block.d(tangent::kRz) = row.Real(7);
                edge.uncertainty.blocks.push_back(std::move(block));
              });
}

void LoadParts(Store& store, const Selection& selection, Selected& selected) {
  ForEachPart(store, selection, selected, "edge_contribution", "name, p.covariance, p.shifts", "idx",
              [](Edge& edge, const Query& row) {
                edge.uncertainty.contributions.push_back({row.Text(1), row.MatrixAt(2), VectorsAt(row, 3)});
              });
  ForEachPart(store, selection, selected, "edge_diagnosis", "code, what, cure", "idx",
              [](Edge& edge, const Query& row) {
                edge.diagnoses.push_back({row.Text(1), row.Text(2), row.Text(3)});
              });
  ForEachPart(store, selection, selected, "edge_figure", "name, value", "name",
              [](Edge& edge, const Query& row) { edge.figures.emplace(row.Text(1), row.Real(2)); });
  ForEachPart(store, selection, selected, "edge_capture", "capture_id, rms, used, note", "idx",
              [](Edge& edge, const Query& row) {
                edge.captures.push_back({row.IdAt<CaptureId>(1), row.Real(2), row.Int(3) != 0, row.Text(4)});
              });
  ForEachPart(store, selection, selected, "edge_evidence", "title, sensor_id, capture_id, digest, suffix", "idx",
              [](Edge& edge, const Query& row) {
                edge.evidence.push_back(
                    {row.Text(1), row.IdAt<SensorId>(2), row.IdAt<CaptureId>(3), row.IdAt<Digest>(4), row.Text(5)});
              });
}

// By which an edge may be weak (model/edges/weak_edge.h).
void LoadOverlap(Store& store, const Selection& selection, Selected& selected) {
  Query query(store,
              "SELECT e.number, p.value FROM edge e JOIN edge_figure p ON p.edge_number = e.number AND p.name = "
              "'overlap_ratio' WHERE " +
                  selection.where);
  query.Bind(selection.key);
  while (query.Step()) {
    const auto place = selected.position.find(query.Int(0));
    if (place != selected.position.end()) selected.edges[place->second].figures.emplace("overlap_ratio", query.Real(1));
  }
}

Result<std::vector<Edge>> LoadSelection(Store& store, const std::string& subject, const Selection& selection) {
  Selected selected;
  RIGCAL_TRY(store.connection().Load(subject, [&] {
    return store.Read([&]() -> Status {
      selected = LoadRows(store, selection);
      if (selected.edges.empty()) return {};
      if (selection.blocks) LoadBlocks(store, selection, selected);
      LoadParts(store, selection, selected);
      return {};
    });
  }));
  return std::move(selected.edges);
}

}  // namespace

Result<std::optional<Edge>> LoadEdge(Store& store, const EdgeId& id) {
  RIGCAL_ASSIGN(std::vector<Edge> edges, LoadSelection(store, "edge " + id.str(), {"e.edge_id = ?", id.str()}));
  if (edges.empty()) return std::nullopt;
  return std::move(edges.front());
}

Result<std::vector<Edge>> LoadEdges(Store& store, const RobotId& robot, bool blocks) {
  return LoadSelection(store, "edges of robot " + robot.str(), {"e.robot_id = ?", robot.str(), blocks});
}

Result<std::vector<Edge>> LoadEdges(Store& store, const SessionId& session) {
  return LoadSelection(store, "edges of session " + session.str(), {"e.session_id = ?", session.str()});
}

Result<std::vector<Edge>> LoadUnmergedEdges(Store& store, const RobotId& robot, EdgeParts parts) {
  const std::string subject = "edges of robot " + robot.str();
  const Selection selection{"e.number IN (SELECT edge_number FROM waiting_merge WHERE robot_id = ?)", robot.str()};
  if (parts == EdgeParts::kAll) return LoadSelection(store, subject, selection);
  return Load<std::vector<Edge>>(store, subject, [&]() -> Result<std::vector<Edge>> {
    Selected selected = LoadRows(store, selection);
    LoadOverlap(store, selection, selected);
    return std::move(selected.edges);
  });
}

Result<std::vector<Edge>> LoadEdgeRows(Store& store, const std::vector<SessionId>& sessions) {
  return Load<std::vector<Edge>>(store, "edges of sessions", [&]() -> Result<std::vector<Edge>> {
    const Selection selection{"e.session_id IN (SELECT value FROM json_each(?))", ListOf(sessions)};
    Selected selected = LoadRows(store, selection);
    LoadOverlap(store, selection, selected);
    return std::move(selected.edges);
  });
}

Result<std::vector<Edge>> LoadEdges(Store& store, const std::vector<EdgeId>& ids, bool blocks) {
  return LoadSelection(store, "edges by id", {"e.edge_id IN (SELECT value FROM json_each(?))", ListOf(ids), blocks});
}

namespace {

// When it began to count, as a number that only grows; of an empty id: after all others.
Result<std::int64_t> TurnOf(Store& store, const RobotId& robot, const EdgeId& id) {
  if (id.empty()) return std::numeric_limits<std::int64_t>::max();
  Query query(store,
              "SELECT c.number FROM edge e JOIN counted_edge c ON c.edge_number = e.number WHERE e.edge_id = ? AND "
              "c.robot_id = ?");
  if (query.Bind(id, robot).Step()) return query.Int(0);
  return Fail(ErrorCode::kNotFound, "edge " + id.str() + " is none of robot " + robot.str(),
              "`rigcal edges " + robot.str() + "` lists those that are.");
}

}  // namespace

Result<std::vector<EdgeId>> LoadEdgeIds(Store& store, const RobotId& robot, const EdgeId& before, std::int64_t limit) {
  return Load<std::vector<EdgeId>>(store, "edges of robot " + robot.str(), [&]() -> Result<std::vector<EdgeId>> {
    RIGCAL_ASSIGN(const std::int64_t turn, TurnOf(store, robot, before));
    Query query(
        store,
        "SELECT e.edge_id FROM counted_edge c CROSS JOIN edge e ON e.number = c.edge_number WHERE c.robot_id = ? "
        "AND c.number < ? ORDER BY c.number DESC LIMIT ?");
    query.Bind(robot, turn, limit);
    std::vector<EdgeId> ids;
    while (query.Step()) ids.push_back(query.IdAt<EdgeId>(0));
    return ids;
  });
}

Result<std::map<EdgeId, Stamp>> LoadMeasuredAt(Store& store, const std::vector<Edge>& edges) {
  using Stamps = std::map<EdgeId, Stamp>;
  std::vector<EdgeId> ids;
  for (const Edge& edge : edges) ids.push_back(edge.id);
  return Load<Stamps>(store, "times of edges", [&]() -> Result<Stamps> {
    Query query(store,
                "SELECT edge.edge_id, coalesce(session.captured_ns, edge.measured_ns, edge.appended_ns) FROM edge "
                "LEFT JOIN session USING (session_id) WHERE edge.edge_id IN (SELECT value FROM json_each(?))");
    query.Bind(ListOf(ids));
    Stamps stamps;
    while (query.Step()) stamps.emplace(query.IdAt<EdgeId>(0), query.Time(1));
    return stamps;
  });
}

Result<std::int64_t> CountEdges(Store& store, const RobotId& robot, std::int64_t watermark) {
  return Load<std::int64_t>(store, "edges of robot " + robot.str(), [&]() -> Result<std::int64_t> {
    // Newer ones are few, all of a robot's are many.
    Query query(
        store,
        "SELECT a.edges - (SELECT count(*) FROM counted_edge c WHERE c.robot_id = a.robot_id AND c.number > ?2) "
        "FROM summary_arrivals a WHERE a.robot_id = ?1");
    return query.Bind(robot, watermark).Step() ? query.Int(0) : 0;
  });
}

Result<std::int64_t> LoadEdgeWatermark(Store& store, const RobotId& robot) {
  return Load<std::int64_t>(store, "edges of robot " + robot.str(), [&]() -> Result<std::int64_t> {
    Query query(store, "SELECT coalesce(max(number), 0) FROM counted_edge WHERE robot_id = ?");
    return query.Bind(robot).Step() ? query.Int(0) : 0;
  });
}

}  // namespace rigcal::storage
