#include "server/dds/record/batch_recorder.h"

#include <algorithm>

#include "server/base/limits_in_force.h"
#include "server/base/log.h"
#include "server/dds/tell/receipts.h"
#include "server/metrics/noted.h"
#include "server/model/edges/admission.h"
#include "storage/edges/edges.h"
#include "storage/sessions/sessions.h"

namespace rigcal::dds {
namespace {

constexpr std::size_t kOpenBatchesMax = 256;
constexpr std::size_t kItemsOfTurnMax = 128;       // some tenths of a second
constexpr std::size_t kOpenItemsMax = 16'000'000;  // bits of all open batches: bounds memory

}  // namespace

// Forgetting a batch costs nothing but loading its bits again.
void BatchRecorder::MakeRoom(std::size_t items) {
  while (!batches_.empty() && (batches_.size() >= kOpenBatchesMax || open_items_ + items > kOpenItemsMax)) {
    if (HasPending()) Commit();
    const auto later = [](const auto& a, const auto& b) { return a.second.last_used < b.second.last_used; };
    const auto oldest = std::min_element(batches_.begin(), batches_.end(), later);
    if (oldest == batches_.end()) return;
    open_items_ -= oldest->second.held.size();
    batches_.erase(oldest);
  }
}

Result<BatchRecorder::Batch*> BatchRecorder::Open(const wire::BatchItem& item) {
  auto found = batches_.find(item.batch);
  if (found == batches_.end()) {
    MakeRoom(item.count);
    RIGCAL_ASSIGN(auto held, storage::LoadBatchHeld(store_, item.batch));
    Batch batch{item.edge.robot, held ? std::move(*held) : std::vector<bool>(item.count, false), 0, 0, 0};
    batch.held_count = static_cast<std::size_t>(std::count(batch.held.begin(), batch.held.end(), true));
    open_items_ += batch.held.size();
    found = batches_.emplace(item.batch, std::move(batch)).first;
  }
  Batch& batch = found->second;
  batch.last_used = ++uses_;
  if (batch.robot == item.edge.robot && batch.held.size() == item.count) return &batch;
  return Fail(ErrorCode::kConflict, "batch " + item.batch.str() + " is known with another robot or number of edges",
              "Push the edges again with `rigcal push-edges`");
}

void BatchRecorder::GiveUp(const RobotId& robot, const BatchId& id, const Error& error) {
  const auto known = batches_.find(id);
  if (known != batches_.end()) open_items_ -= known->second.held.size();
  if (known != batches_.end()) batches_.erase(known);
  pending_.erase(id);
  dirty_.erase(id);
  SendRefusal(robot, id, error);
}

void BatchRecorder::Take(wire::BatchItem& item) {
  if (const Status past = CheckMeasuredAt(item.edge, clock_.Now()); !past)
    return SendRefusal(item.edge.robot, item.batch, past.error());
  const auto batch = Open(item);
  if (!batch) return SendRefusal(item.edge.robot, item.batch, batch.error());
  ++(*batch)->written_bytes;
  dirty_.insert(item.batch);
  if (!(*batch)->held[item.idx]) pending_[item.batch].push_back(std::move(item));
}

Status BatchRecorder::RecordItems(const BatchId& id, std::size_t first, std::size_t end) {
  const Stamp now = clock_.Now();
  const auto& items = pending_.at(id);
  const RobotId& robot = items.front().edge.robot;
  RIGCAL_TRY(storage::AppendRobot(store_, robot, now));
  RIGCAL_TRY(storage::AppendBatch(store_, robot, id, items.front().count, now));
  for (std::size_t i = first; i < end; ++i)
    RIGCAL_TRY(storage::AppendBatchItem(store_, id, items[i].idx, items[i].edge, now));
  return {};
}

// Where others write to the store, too, none waits long for its turn.
Status BatchRecorder::RecordInTurns(const BatchId& id) {
  const std::size_t count = pending_.at(id).size();
  for (std::size_t first = 0; first < count; first += kItemsOfTurnMax)
    RIGCAL_TRY(store_.Write([&] { return RecordItems(id, first, std::min(first + kItemsOfTurnMax, count)); }));
  return {};
}

Status BatchRecorder::Record(const std::vector<BatchId>& ids) {
  if (!store_.place().server.empty()) {
    for (const BatchId& id : ids) RIGCAL_TRY(RecordInTurns(id));
    return {};
  }
  return store_.Write([&]() -> Status {
    for (const BatchId& id : ids) RIGCAL_TRY(RecordItems(id, 0, pending_.at(id).size()));
    return {};
  });
}

void BatchRecorder::Announce(const BatchId& id) {
  Batch& batch = batches_.at(id);
  const std::size_t held_before = batch.held_count;
  for (const wire::BatchItem& item : pending_[id]) {
    if (batch.held[item.idx]) continue;
    batch.held[item.idx] = true;
    ++batch.held_count;
  }
  if (!pending_[id].empty() && batch.held_count == batch.held.size()) callbacks_.work_arrived(batch.robot);
  if (batch.held_count > held_before) NoteStored(id, batch, batch.held_count - held_before);
  SendReceipt(id, batch);
}

void BatchRecorder::NoteStored(const BatchId& id, const Batch& batch, std::size_t edges) {
  metrics::NotePushedEdges(edges);
  const bool all_held = batch.held_count == batch.held.size();
  LogReceipt({.robot = batch.robot.str()}, all_held ? wire::ReceiptState::kClosed : wire::ReceiptState::kReceiving,
             "robot " + batch.robot.str() + ", batch " + id.str() + ": " + std::to_string(edges) + " edges stored, " +
                 std::to_string(batch.held_count) + " of " + std::to_string(batch.held.size()));
}

// Where nobody else writes one transaction for all; if that fails, each batch by itself, so that a bad one harms no
// other.
void BatchRecorder::Commit() {
  std::vector<BatchId> ids;
  for (const auto& [id, items] : pending_) ids.push_back(id);
  const bool all_done = ids.empty() || Record(ids).has_value();
  for (const BatchId& id : ids) {
    const Status done = all_done ? Status() : Record({id});
    if (done) continue;
    SendRefusal(batches_.at(id).robot, id, done.error());
    dirty_.erase(id);
  }
  for (const BatchId& id : dirty_) Announce(id);
  pending_.clear();
  dirty_.clear();
}

void BatchRecorder::SendReceipt(const BatchId& id, const Batch& batch) {
  wire::Receipt receipt;
  receipt.robot = batch.robot;
  receipt.subject_id = id.str();
  const bool all_held = batch.held_count == batch.held.size();
  receipt.state = all_held ? wire::ReceiptState::kClosed : wire::ReceiptState::kReceiving;
  receipt.incarnation = incarnation_;
  receipt.window_bytes = static_cast<std::uint64_t>(limits::InForce().window_bytes);
  receipt.written_bytes = batch.written_bytes;
  receipt.held = batch.held;
  outbox_.Send(batch.robot, std::move(receipt));
}

void BatchRecorder::SendRefusal(const RobotId& robot, const BatchId& id, const Error& error) {
  LogRefusal({.robot = robot.str()}, "robot " + robot.str() + ", batch " + id.str() + " refused: ", error);
  outbox_.Send(robot, RefusalReceipt(robot, id.str(), incarnation_, error));
}

}  // namespace rigcal::dds
