#include "storage/edges.h"
#include "storage/query.h"
#include "storage/sessions.h"

namespace rigcal::storage {
namespace {

struct BatchRow {
  std::int64_t number = 0;
  std::int64_t item_count = 0;
};

struct EdgeRow {
  std::int64_t number = 0;
  Stamp appended_at;
};

std::string Subject(const BatchId& batch) { return "batch " + batch.str(); }

std::optional<BatchRow> FindBatch(Store& store, const BatchId& batch) {
  Query query(store, "SELECT number, item_count FROM batch WHERE batch_id = ?");
  if (!query.Bind(batch).Step()) return std::nullopt;
  return BatchRow{query.Int(0), query.Int(1)};
}

Result<EdgeRow> FindEdge(Store& store, const EdgeId& edge) {
  Query query(store, "SELECT number, appended_ns FROM edge WHERE edge_id = ?");
  if (query.Bind(edge).Step()) return EdgeRow{query.Int(0), query.Time(1)};
  return Fail(ErrorCode::kNotFound, "edge " + edge.str() + " is not stored", "Append it before its item of a batch.");
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
  Query(store, "INSERT INTO batch (batch_id, robot_id, item_count, appended_ns) VALUES (?, ?, ?, ?)")
      .Bind(batch, robot, count, now)
      .Run();
  if (count == 0) return;
  Query(store, "INSERT INTO waiting_batch VALUES (?, ?, ?, ?)")
      .Bind(store.database().getLastInsertRowid(), robot, count, now)
      .Run();
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

Status CheckSame(Store& store, const BatchId& batch, std::int64_t batch_number, std::int64_t item_idx,
                 std::int64_t edge_number) {
  Query query(store, "SELECT edge_number FROM batch_item WHERE batch_number = ? AND idx = ?");
  if (query.Bind(batch_number, item_idx).Step() && query.Int(0) == edge_number) return {};
  return Fail(ErrorCode::kConflict, Subject(batch) + " holds another edge as item " + std::to_string(item_idx),
              "Give each set of edges its own batch id.");
}

void CountDown(Store& store, std::int64_t batch_number, Stamp appended_at) {
  // The last item first: a row that is to go need not be changed.
  const bool last =
      Query(store, "DELETE FROM waiting_batch WHERE batch_number = ? AND missing_count = 1").Bind(batch_number).Run() >
      0;
  if (last) return;
  Query(store,
        "UPDATE waiting_batch SET missing_count = missing_count - 1, newest_ns = max(newest_ns, ?) "
        "WHERE batch_number = ?")
      .Bind(appended_at, batch_number)
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

Status AppendBatchItem(Store& store, const BatchId& batch, std::int64_t item_idx, const EdgeId& edge) {
  return store.connection().Append(Subject(batch), [&]() -> Status {
    RIGCAL_ASSIGN(const BatchRow place, FindPlace(store, batch, item_idx));
    RIGCAL_ASSIGN(const EdgeRow row, FindEdge(store, edge));
    Query insert(store, "INSERT INTO batch_item VALUES (?, ?, ?) ON CONFLICT DO NOTHING");
    if (insert.Bind(place.number, item_idx, row.number).Run() == 0)
      return CheckSame(store, batch, place.number, item_idx, row.number);
    CountDown(store, place.number, row.appended_at);
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

Result<std::optional<Stamp>> LoadOpenBatch(Store& store, const RobotId& robot) {
  return Load<std::optional<Stamp>>(store, "batches of robot " + robot.str(), [&]() -> Result<std::optional<Stamp>> {
    Query query(store, "SELECT newest_ns FROM waiting_batch WHERE robot_id = ? ORDER BY newest_ns DESC LIMIT 1");
    if (!query.Bind(robot).Step()) return std::nullopt;
    return query.Time(0);
  });
}

}  // namespace rigcal::storage
