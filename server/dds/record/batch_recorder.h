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
  struct Batch {
    RobotId robot;
    std::vector<bool> held;
    std::size_t held_count = 0;
    std::uint64_t written_bytes = 0;  // counts items
    std::uint64_t last_used = 0;
  };

  [[nodiscard]] Result<Batch*> Open(const wire::BatchItem& item);
  void MakeRoom(std::size_t items);
  [[nodiscard]] Status RecordItems(const BatchId& id, std::size_t first, std::size_t end);
  [[nodiscard]] Status RecordInTurns(const BatchId& id);
  [[nodiscard]] Status Record(const std::vector<BatchId>& ids);
  void Announce(const BatchId& id);
  void SendReceipt(const BatchId& id, const Batch& batch);
  void NoteStored(const BatchId& id, const Batch& batch, std::size_t edges);
  void SendRefusal(const RobotId& robot, const BatchId& id, const Error& error);

  storage::Store& store_;
  Outbox& outbox_;
  const Callbacks& callbacks_;
  const Clock& clock_;
  std::uint64_t incarnation_, uses_ = 0;
  std::size_t open_items_ = 0;
  std::unordered_map<BatchId, Batch> batches_;
  std::map<BatchId, std::vector<wire::BatchItem>> pending_;
  std::set<BatchId> dirty_;  // their clients want to hear
};

}  // namespace rigcal::dds
