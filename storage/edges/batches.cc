#include <map>
#include <set>

#include "storage/database/query.h"
#include "storage/edges/edge_row.h"
#include "storage/edges/edges.h"
#include "storage/sessions/sessions.h"

namespace rigcal::storage {
namespace {

struct BatchRow {
  std::int64_t number = 0;
  std::int64_t item_count = 0;
};

std::string Subject(const BatchId& batch) { return "batch " + batch.str(); }

std::optional<BatchRow> FindBatch(Store& store, const BatchId& batch) {
  Query query(store, "SELECT number, item_count FROM batch WHERE batch_id = ?");
  if (!query.Bind(batch).Step()) return std::nullopt;
  return BatchRow{query.Int(0), query.Int(1)};
}

Result<BatchRow> FindPlaces(Store& store, const BatchId& batch, const std::vector<BatchEdge>& items) {
  const std::optional<BatchRow> row = FindBatch(store, batch);
  if (!row) return Fail(ErrorCode::kNotFound, Subject(batch) + " is not known", "Append it before its items.");
  for (const auto& [idx, edge] : items)
    if (idx < 0 || idx >= row->item_count)
      return Fail(ErrorCode::kInvalidInput,
                  Subject(batch) + " has no item " + std::to_string(idx) + ", only " + std::to_string(row->item_count),
                  "Number the items of a batch from 0.");
  return *row;
}

void InsertBatch(Store& store, const RobotId& robot, const BatchId& batch, std::int64_t count, Stamp now) {
  const auto number =
      Query(store,
            "INSERT INTO batch (batch_id, robot_id, item_count, appended_ns) VALUES (?, ?, ?, ?) RETURNING number")
          .Bind(batch, robot, count, now)
          .RunForKey();
  if (count == 0) return;
  Query(store, "INSERT INTO waiting_batch VALUES (?, ?, ?, ?)").Bind(number, robot, count, now).Run();
}

void Touch(Store& store, std::int64_t batch_number, Stamp now) {
  Query(store, "UPDATE waiting_batch SET newest_ns = ? WHERE batch_number = ? AND newest_ns < ?")
      .Bind(now, batch_number, now)
      .Run();
}

Status CheckCount(const BatchId& batch, const BatchRow& row, std::int64_t count) {
  if (row.item_count == count) return {};
  return Fail(
      ErrorCode::kConflict,
      Subject(batch) + " is known with " + std::to_string(row.item_count) + " items, not " + std::to_string(count),
      "Give each set of edges its own batch id.");
}

// Which edge each of the items is; of an item that is not there, nothing.
std::map<std::int64_t, EdgeId> HeldItems(Store& store, std::int64_t batch_number, const std::vector<BatchEdge>& items) {
  std::vector<std::int64_t> indices;
  for (const BatchEdge& item : items) indices.push_back(item.idx);
  Query query(store,
              "SELECT i.idx, e.edge_id FROM batch_item i JOIN edge e ON e.number = i.edge_number "
              "WHERE i.batch_number = ? AND i.idx IN (SELECT CAST(value AS BIGINT) FROM json_each(?))");
  query.Bind(batch_number, ListOf(indices));
  std::map<std::int64_t, EdgeId> held;
  while (query.Step()) held.emplace(query.Int(0), query.IdAt<EdgeId>(1));
  return held;
}

// Those that are not there yet, in their order. kConflict if one is there, or comes twice, as another edge.
Result<std::map<std::int64_t, const Edge*>> NewItems(Store& store, const BatchId& batch, std::int64_t batch_number,
                                                     const std::vector<BatchEdge>& items) {
  std::map<std::int64_t, EdgeId> held = HeldItems(store, batch_number, items);
  std::map<std::int64_t, const Edge*> fresh;
  for (const BatchEdge& item : items) {
    const auto [known, is_new] = held.emplace(item.idx, item.edge.id);
    if (is_new) fresh.emplace(item.idx, &item.edge);
    if (known->second != item.edge.id)
      return Fail(ErrorCode::kConflict, Subject(batch) + " holds another edge as item " + std::to_string(item.idx),
                  "Give each set of edges its own batch id.");
  }
  return fresh;
}

// True if those were the last ones that were missing.
bool CountDown(Store& store, std::int64_t batch_number, std::size_t by, Stamp now) {
  // The last items first: a row that is to go need not be changed.
  const bool last = Query(store, "DELETE FROM waiting_batch WHERE batch_number = ? AND missing_count = ?")
                        .Bind(batch_number, by)
                        .Run() > 0;
  if (last) return true;
  Query(store,
        "UPDATE waiting_batch SET missing_count = missing_count - ?, newest_ns = max(newest_ns, ?) "
        "WHERE batch_number = ?")
      .Bind(by, now, batch_number)
      .Run();
  return false;
}

// From now on all its edges count; some may do so already, by another batch.
void CountEdges(Store& store, std::int64_t batch_number) {
  Query(store,
        "INSERT INTO counted_edge (edge_number, robot_id) SELECT e.number, e.robot_id FROM batch_item i CROSS JOIN "
        "edge e ON e.number = i.edge_number WHERE i.batch_number = ? ORDER BY i.idx ON CONFLICT DO NOTHING")
      .Bind(batch_number)
      .Run();
}

}  // namespace

Status AppendBatch(Store& store, const RobotId& robot, const BatchId& batch, std::int64_t count, Stamp now) {
  return store.connection().Append(Subject(batch), [&]() -> Status {
    RIGCAL_TRY(CheckName(RobotTag::kKind, robot.str()));
    if (count < 0) return Fail(ErrorCode::kInvalidInput, Subject(batch) + " has a negative count", "Count its edges.");
    if (const std::optional<BatchRow> row = FindBatch(store, batch)) {
      RIGCAL_TRY(CheckCount(batch, *row, count));
      Touch(store, row->number, now);
      return {};
    }
    RIGCAL_TRY(AppendRobot(store, robot, now));
    InsertBatch(store, robot, batch, count, now);
    return {};
  });
}

Status AppendBatchItems(Store& store, const BatchId& batch, const std::vector<BatchEdge>& items, Stamp now) {
  return store.connection().Append(Subject(batch), [&]() -> Status {
    RIGCAL_ASSIGN(const BatchRow place, FindPlaces(store, batch, items));
    RIGCAL_ASSIGN(const auto fresh, NewItems(store, batch, place.number, items));
    if (fresh.empty()) return {};
    std::set<RobotId> robots;
    for (const auto& [idx, edge] : fresh) {
      RIGCAL_TRY(CheckEdgeRow(*edge));
      robots.insert(edge->robot);
    }
    for (const RobotId& robot : robots) RIGCAL_TRY(AppendRobot(store, robot, now));
    for (const auto& [idx, edge] : fresh)
      Query(store, "INSERT INTO batch_item VALUES (?, ?, ?)")
          .Bind(place.number, idx, InsertEdgeRow(store, *edge, now))
          .Run();
    if (CountDown(store, place.number, fresh.size(), now)) CountEdges(store, place.number);
    return {};
  });
}

Result<std::optional<std::vector<bool>>> LoadBatchHeld(Store& store, const BatchId& batch) {
  using Held = std::optional<std::vector<bool>>;
  return Load<Held>(store, Subject(batch), [&]() -> Result<Held> {
    const std::optional<BatchRow> row = FindBatch(store, batch);
    if (!row) return std::nullopt;
    std::vector<bool> held(static_cast<std::size_t>(row->item_count), false);
    Query query(store, "SELECT idx FROM batch_item WHERE batch_number = ?");
    query.Bind(row->number);
    while (query.Step()) held.at(static_cast<std::size_t>(query.Int(0))) = true;
    return held;
  });
}

Result<std::vector<OpenBatch>> LoadOpenBatches(Store& store, const RobotId& robot) {
  return Load<std::vector<OpenBatch>>(store, "incomplete batches", [&]() -> Result<std::vector<OpenBatch>> {
    Query query(store,
                "SELECT b.batch_id, b.robot_id, b.item_count, b.item_count - w.missing_count, b.appended_ns, "
                "w.newest_ns FROM waiting_batch w CROSS JOIN batch b ON b.number = w.batch_number "
                "WHERE ? IN (w.robot_id, '') ORDER BY b.number");
    query.Bind(robot);
    std::vector<OpenBatch> batches;
    while (query.Step())
      batches.push_back(
          {query.IdAt<BatchId>(0), query.IdAt<RobotId>(1), query.Int(2), query.Int(3), query.Time(4), query.Time(5)});
    return batches;
  });
}

}  // namespace rigcal::storage
