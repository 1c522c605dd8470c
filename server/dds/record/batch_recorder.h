// Batches of finished edges: each drain becomes one transaction, then receipts. Edges of a batch count once all of it
// is stored (storage/edges/edges.h). Thread W only.
#pragma once

#include <map>
#include <set>
#include <unordered_map>
#include <vector>

#include "server/dds/tell/outbox.h"
#include "storage/store.h"

namespace rigcal::dds {

// Of one that is being received, or was lately.
struct OpenBatch {
  RobotId robot;
  std::vector<bool> held;
  std::size_t held_count = 0;
  std::uint64_t written_bytes = 0;  // counts items
  std::uint64_t last_used = 0;
  [[nodiscard]] bool AllHeld() const { return held_count == held.size(); }
};

// So many of them in memory; forgetting one costs nothing but loading its bits again.
class OpenBatches {
 public:
  // Null: it is none of them. It is the one used last, then.
  [[nodiscard]] OpenBatch* Find(const BatchId& id);
  // One that is there.
  [[nodiscard]] OpenBatch& At(const BatchId& id) { return batches_.at(id); }
  OpenBatch& Add(const BatchId& id, OpenBatch batch);
  void Remove(const BatchId& id);
  // Whether one has to go before one of so many items is added.
  [[nodiscard]] bool IsFullFor(std::size_t items) const;
  // That which was used longest ago.
  void RemoveOldest();

 private:
  std::unordered_map<BatchId, OpenBatch> batches_;
  std::size_t items_ = 0;
  std::uint64_t uses_ = 0;
};

class BatchRecorder {
 public:
  // All outlive it.
  BatchRecorder(storage::Store& store, Outbox& outbox, const Callbacks& callbacks, const Clock& clock,
                std::uint64_t incarnation)
      : store_(store), outbox_(outbox), callbacks_(callbacks), clock_(clock), incarnation_(incarnation) {}

  // Keeps the item for Commit, which tells the client; one that does not fit its batch is refused at once.
  void Take(wire::BatchItem& item);  // moves it away once nothing can be thrown any more
  // What came of a batch could not be taken: what waits of it is dropped, and its client told why.
  void GiveUp(const RobotId& robot, const BatchId& id, const Error& error);
  // Whether Commit has something to record or to tell.
  [[nodiscard]] bool HasPending() const { return !pending_.empty() || !dirty_.empty(); }
  // Records what was taken in ONE transaction, then tells the clients.
  void Commit();

 private:
  [[nodiscard]] Result<OpenBatch*> Open(const wire::BatchItem& item);
  [[nodiscard]] Status Record(const std::vector<BatchId>& ids);
  void Announce(const BatchId& id);
  void SendRefusal(const RobotId& robot, const BatchId& id, const Error& error);

  storage::Store& store_;
  Outbox& outbox_;
  const Callbacks& callbacks_;
  const Clock& clock_;
  std::uint64_t incarnation_;
  OpenBatches batches_;
  std::map<BatchId, std::vector<wire::BatchItem>> pending_;
  std::set<BatchId> dirty_;  // their clients want to hear
};

}  // namespace rigcal::dds
