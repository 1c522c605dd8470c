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

Result<BatchRow> FindPlace(Store& store, const BatchId& batch, std::int64_t item_idx) {
  const std::optional<BatchRow> row = FindBatch(store, batch);
  if (!row) return Fail(ErrorCode::kNotFound, Subject(batch) + " is not known", "Append it before its items.");
  if (item_idx >= 0 && item_idx < row->item_count) return *row;
  return Fail(ErrorCode::kInvalidInput,
              Subject(batch) + " has no item " + std::to_string(item_idx) + ", only " + std::to_string(row->item_count),
              "Number the items of a batch from 0.");
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

// Is the item there already? kConflict if it is another edge.
Result<bool> HasItem(Store& store, const BatchId& batch, std::int64_t batch_number, std::int64_t item_idx,
                     const EdgeId& edge) {
  Query query(store,
              "SELECT e.edge_id FROM batch_item i JOIN edge e ON e.number = i.edge_number "
              "WHERE i.batch_number = ? AND i.idx = ?");
  if (!query.Bind(batch_number, item_idx).Step()) return false;
  if (query.IdAt<EdgeId>(0) == edge) return true;
  return Fail(ErrorCode::kConflict, Subject(batch) + " holds another edge as item " + std::to_string(item_idx),
              "Give each set of edges its own batch id.");
}

// True if that was the last one that was missing.
bool CountDown(Store& store, std::int64_t batch_number, Stamp now) {
  // The last item first: a row that is to go need not be changed.
  const bool last =
      Query(store, "DELETE FROM waiting_batch WHERE batch_number = ? AND missing_count = 1").Bind(batch_number).Run() >
      0;
  if (last) return true;
  Query(store,
        "UPDATE waiting_batch SET missing_count = missing_count - 1, newest_ns = max(newest_ns, ?) "
        "WHERE batch_number = ?")
      .Bind(now, batch_number)
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

Status AppendBatchItem(Store& store, const BatchId& batch, std::int64_t item_idx, const Edge& edge, Stamp now) {
  return store.connection().Append(Subject(batch), [&]() -> Status {
    RIGCAL_ASSIGN(const BatchRow place, FindPlace(store, batch, item_idx));
    RIGCAL_ASSIGN(const bool is_there, HasItem(store, batch, place.number, item_idx, edge.id));
    if (is_there) return {};
    RIGCAL_ASSIGN(const std::int64_t edge_number, AppendEdgeRow(store, edge, now));
    Query(store, "INSERT INTO batch_item VALUES (?, ?, ?)").Bind(place.number, item_idx, edge_number).Run();
    if (CountDown(store, place.number, now)) CountEdges(store, place.number);
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
