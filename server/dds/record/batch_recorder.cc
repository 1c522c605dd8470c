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

using BatchItems = std::vector<wire::BatchItem>;

// Those from `first` up to `end`, inside a Write.
Status RecordItems(storage::Store& store, const BatchId& id, const BatchItems& items, std::size_t first,
                   std::size_t end, Stamp now) {
  const RobotId& robot = items.front().edge.robot;
  RIGCAL_TRY(storage::AppendRobot(store, robot, now));
  RIGCAL_TRY(storage::AppendBatch(store, robot, id, items.front().count, now));
  std::vector<storage::BatchEdge> edges;
  for (std::size_t i = first; i < end; ++i) edges.push_back({items[i].idx, items[i].edge});
  return storage::AppendBatchItems(store, id, edges, now);
}

// Where others write to the store, too, none waits long for its turn.
Status RecordInTurns(storage::Store& store, const BatchId& id, const BatchItems& items, const Clock& clock) {
  const std::size_t count = items.size();
  for (std::size_t first = 0; first < count; first += kItemsOfTurnMax)
    RIGCAL_TRY(store.Write(
        [&] { return RecordItems(store, id, items, first, std::min(first + kItemsOfTurnMax, count), clock.Now()); }));
  return {};
}

wire::ReceiptState ReceiptStateOf(const OpenBatch& batch) {
  return batch.AllHeld() ? wire::ReceiptState::kClosed : wire::ReceiptState::kReceiving;
}

void NoteStored(const BatchId& id, const OpenBatch& batch, std::size_t edges) {
  metrics::NotePushedEdges(edges);
  LogReceipt({.robot = batch.robot.str()}, ReceiptStateOf(batch),
             "robot " + batch.robot.str() + ", batch " + id.str() + ": " + std::to_string(edges) + " edges stored, " +
                 std::to_string(batch.held_count) + " of " + std::to_string(batch.held.size()));
}

wire::Receipt ReceiptOf(const BatchId& id, const OpenBatch& batch, std::uint64_t incarnation) {
  wire::Receipt receipt;
  receipt.robot = batch.robot;
  receipt.subject_id = id.str();
  receipt.state = ReceiptStateOf(batch);
  receipt.incarnation = incarnation;
  receipt.window_bytes = static_cast<std::uint64_t>(limits::InForce().window_bytes);
  receipt.written_bytes = batch.written_bytes;
  receipt.held = batch.held;
  return receipt;
}

}  // namespace

OpenBatch* OpenBatches::Find(const BatchId& id) {
  const auto found = batches_.find(id);
  if (found == batches_.end()) return nullptr;
  found->second.last_used = ++uses_;
  return &found->second;
}

OpenBatch& OpenBatches::Add(const BatchId& id, OpenBatch batch) {
  items_ += batch.held.size();
  OpenBatch& added = batches_.emplace(id, std::move(batch)).first->second;
  added.last_used = ++uses_;
  return added;
}

void OpenBatches::Remove(const BatchId& id) {
  const auto known = batches_.find(id);
  if (known == batches_.end()) return;
  items_ -= known->second.held.size();
  batches_.erase(known);
}

bool OpenBatches::IsFullFor(std::size_t items) const {
  return !batches_.empty() && (batches_.size() >= kOpenBatchesMax || items_ + items > kOpenItemsMax);
}

void OpenBatches::RemoveOldest() {
  const auto later = [](const auto& a, const auto& b) { return a.second.last_used < b.second.last_used; };
  const auto oldest = std::min_element(batches_.begin(), batches_.end(), later);
  if (oldest != batches_.end()) Remove(BatchId(oldest->first));
}

Result<OpenBatch*> BatchRecorder::Open(const wire::BatchItem& item) {
  const auto fits = [&](const OpenBatch& batch) {
    return batch.robot == item.edge.robot && batch.held.size() == item.count;
  };
  const Error other{ErrorCode::kConflict,
                    "batch " + item.batch.str() + " is known with another robot or number of edges",
                    "Push the edges again with `rigcal push-edges`"};
  if (OpenBatch* known = batches_.Find(item.batch)) return fits(*known) ? Result<OpenBatch*>(known) : Fail(other);
  while (batches_.IsFullFor(item.count)) {
    if (HasPending()) Commit();
    batches_.RemoveOldest();
  }
  RIGCAL_ASSIGN(auto held, storage::LoadBatchHeld(store_, item.batch));
  OpenBatch opened{item.edge.robot, held ? std::move(*held) : std::vector<bool>(item.count, false), 0, 0, 0};
  if (!fits(opened)) return Fail(other);
  opened.held_count = static_cast<std::size_t>(std::count(opened.held.begin(), opened.held.end(), true));
  OpenBatch& batch = batches_.Add(item.batch, std::move(opened));
  // Whoever pushes learns at once what is held, and sends the rest while its first item is stored.
  if (!batch.AllHeld()) outbox_.Send(batch.robot, ReceiptOf(item.batch, batch, incarnation_));
  return &batch;
}

void BatchRecorder::GiveUp(const RobotId& robot, const BatchId& id, const Error& error) {
  batches_.Remove(id);
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

Status BatchRecorder::Record(const std::vector<BatchId>& ids) {
  if (!store_.place().server.empty()) {
    for (const BatchId& id : ids) RIGCAL_TRY(RecordInTurns(store_, id, pending_.at(id), clock_));
    return {};
  }
  return store_.Write([&]() -> Status {
    for (const BatchId& id : ids)
      RIGCAL_TRY(RecordItems(store_, id, pending_.at(id), 0, pending_.at(id).size(), clock_.Now()));
    return {};
  });
}

void BatchRecorder::Announce(const BatchId& id) {
  OpenBatch& batch = batches_.At(id);
  const std::size_t held_before = batch.held_count;
  for (const wire::BatchItem& item : pending_[id]) {
    if (batch.held[item.idx]) continue;
    batch.held[item.idx] = true;
    ++batch.held_count;
  }
  if (!pending_[id].empty() && batch.AllHeld()) callbacks_.work_arrived(batch.robot);
  if (batch.held_count > held_before) NoteStored(id, batch, batch.held_count - held_before);
  outbox_.Send(batch.robot, ReceiptOf(id, batch, incarnation_));
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
    SendRefusal(batches_.At(id).robot, id, done.error());
    dirty_.erase(id);
  }
  for (const BatchId& id : dirty_) Announce(id);
  pending_.clear();
  dirty_.clear();
}

void BatchRecorder::SendRefusal(const RobotId& robot, const BatchId& id, const Error& error) {
  LogRefusal({.robot = robot.str()}, "robot " + robot.str() + ", batch " + id.str() + " refused: ", error);
  outbox_.Send(robot, RefusalReceipt(robot, id.str(), incarnation_, error));
}

}  // namespace rigcal::dds
