// Complete payload files become durable together, and with the last of a session its row says closed and its pairs
// wait as jobs. Then the receipts go out: a receipt means on disk. Thread W only.
#pragma once

#include <atomic>
#include <chrono>
#include <functional>
#include <future>
#include <map>
#include <optional>
#include <set>
#include <vector>

#include "server/base/files/cached_files.h"
#include "server/base/stamp.h"
#include "server/dds/record/open_sessions.h"
#include "server/dds/record/session_receipts.h"
#include "server/dds/service.h"
#include "storage/files/blobs.h"
#include "storage/store.h"

namespace rigcal::dds {

struct DurableBatch {
  std::vector<storage::FinishedFile> files;
  std::int64_t bytes = 0;                             // of the files
  std::map<SessionId, std::set<std::uint32_t>> held;  // payloads that become held
  std::set<SessionId> closing;                        // sessions of `held` of which they are the last
};

// One batch at a time becomes durable, on a thread of its own: meanwhile thread W takes and writes the next.
class DurableCommit {
 public:
  // Both outlive it, `store` for the commits alone; `done` is called from their thread.
  DurableCommit(storage::Store& store, const Clock& clock, std::function<void()> done);
  [[nodiscard]] bool Runs() const { return ended_.valid(); }
  [[nodiscard]] bool IsIntoBucket() const { return store_.blobs().bucket() != nullptr; }
  // Where none runs.
  void Start(DurableBatch batch);
  // Good: everything of the batch survives power loss; an error: nothing of it is recorded; nothing: none runs, or it
  // is not done and `waits` is false.
  [[nodiscard]] std::optional<Status> Finish(bool waits);
  // That of the last Start.
  [[nodiscard]] const DurableBatch& batch() const { return batch_; }

 private:
  storage::Store& store_;
  const Clock& clock_;
  const std::function<void()> done_;
  CachedFiles cached_;    // of the commits' thread
  std::set<Digest> put_;  // likewise: of what a bucket holds up, what came there
  DurableBatch batch_;    // likewise while it runs
  std::atomic<bool> is_done_{false};
  std::future<Status> ended_;  // last: waited for before anything else goes
};

// A payload file that is whole, with the hash that its manifest gives.
struct FinishedPayload {
  SessionId session;
  std::uint32_t payload_idx = 0;
  std::filesystem::path path;
  Digest digest;
  std::int64_t size_bytes = 0;
};

class SessionCommits {
 public:
  // All outlive it. `store` and `done`: as of DurableCommit.
  SessionCommits(storage::Store& store, OpenSessions& sessions, SessionReceipts& receipts, const Callbacks& callbacks,
                 const Clock& clock, std::function<void()> done);

  // For the next commit.
  void Add(FinishedPayload payload) { finished_.push_back(std::move(payload)); }
  // While one runs the next payloads come in, and are committed together when it is done.
  void CommitDue();
  // Commits all and waits; but for what a bucket out of reach holds up.
  void Settle();
  // No more is received of it, whatever waits.
  void Remove(const SessionId& session);
  // Likewise, as what came of it could not be taken: its client is told why.
  void GiveUp(const RobotId& robot, const SessionId& session, const Error& error);

 private:
  [[nodiscard]] std::int64_t PendingBytes() const;
  void Start();
  void Finish(bool waits);
  void Announce(const DurableBatch& batch);
  void AnnounceHeld(const SessionId& session, const std::set<std::uint32_t>& payload_idx);
  void GiveUp(const DurableBatch& batch, const Error& error);
  void HoldUp(const Error& error);
  [[nodiscard]] bool IsHeldUp() const { return std::chrono::steady_clock::now() < again_at_; }

  OpenSessions& sessions_;
  SessionReceipts& receipts_;
  const Callbacks& callbacks_;
  std::vector<FinishedPayload> finished_, committing_;
  std::chrono::steady_clock::time_point again_at_;  // a bucket that is out of reach is not asked before
  DurableCommit commit_;
};

}  // namespace rigcal::dds
