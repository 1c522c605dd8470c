// Sessions from header to closed: manifests, payload files, held bits, receipts. Thread W only.
#pragma once

#include <atomic>
#include <functional>
#include <future>
#include <memory>
#include <set>
#include <unordered_map>
#include <vector>

#include "server/dds/record/durable_batch.h"
#include "server/dds/record/session_intake.h"
#include "server/dds/tell/outbox.h"
#include "storage/store.h"

namespace rigcal::dds {

class SessionRecorder {
 public:
  // All outlive it. `commit_store`: the commits' own connection; `commit_done` is called from their thread. Empties
  // Options::intake: what was not receipted before is sent again.
  SessionRecorder(storage::Store& store, storage::Store& commit_store, const std::string& intake, Outbox& outbox,
                  const Callbacks& callbacks, const Clock& clock, std::uint64_t incarnation,
                  std::function<void()> commit_done);

  // The first two are answered at once, by a receipt or a refusal; what became of chunks is told in Report. A chunk of
  // a session that is not open only tells the client where that stands.
  void Take(const OpenSession& open);
  void Take(const ManifestText& text);
  void Take(ChunkBytes& chunk);  // takes its bytes
  void Take(const DiscardedChunk& chunk);

  // What came of a session could not be taken: it is dropped as it is received, and its client told why.
  void GiveUp(const RobotId& robot, const SessionId& session, const Error& error);

  // After a round of Takes: writes and hashes on all processors.
  void Write();
  // Then: tells the clients how far it is.
  void Report();
  // Complete files that no commit has taken up yet.
  [[nodiscard]] std::int64_t PendingBytes() const;
  // Makes them durable on a thread of its own, if none runs.
  void StartCommit();
  enum class Patience { kNone, kAll };
  // Sends the receipts of the commit that runs, if it is done; kAll waits for it.
  void FinishCommit(Patience patience);
  // Commits all and waits.
  void Settle();
  // Sessions that are being received. Any thread.
  [[nodiscard]] std::size_t OpenSessions() const { return open_sessions_; }

 private:
  struct Finished {
    SessionId session;
    std::uint32_t payload_idx = 0;
    std::filesystem::path path;
    Digest digest;
    std::int64_t size_bytes = 0;
  };

  [[nodiscard]] Result<wire::ReceiptState> Open(const RobotId& robot, const SessionId& session);
  [[nodiscard]] Status PushAgain(const RobotId& robot, const SessionId& session);
  void Tell(const RobotId& robot, const SessionId& session, const Result<wire::ReceiptState>& state);
  [[nodiscard]] Status StoreManifest(const ManifestText& text);
  [[nodiscard]] Result<bool> StoreHeldElsewhere(const SessionId& session, const Manifest& manifest);
  [[nodiscard]] Result<SessionIntake*> AddIntake(const RobotId& robot, const SessionId& session,
                                                 const Manifest& manifest);
  [[nodiscard]] SessionIntake* Find(const SessionId& session);
  [[nodiscard]] SessionIntake* Prepare(const RobotId& robot, const SessionId& session);
  void MakeRoom(std::size_t payloads);
  void Remove(const SessionId& session);

  void Complete(SessionIntake& intake, std::uint32_t payload_idx, const Result<Digest>& digest);
  void WriteTouched();
  void ReportAll();
  void Announce(const DurableBatch& batch);
  void AnnounceHeld(const SessionId& session, const std::set<std::uint32_t>& payload_idx);
  void GiveUp(const DurableBatch& batch, const Error& error);
  void LogHeld(const SessionIntake& intake, bool is_closed) const;

  void SendState(const RobotId& robot, const SessionId& session, wire::ReceiptState state);
  void SendRefusal(const RobotId& robot, const SessionId& session, const Error& error);
  [[nodiscard]] std::int64_t WindowBytes() const;

  storage::Store &store_, &commit_store_;
  const std::filesystem::path folder_;  // of what is being received
  Outbox& outbox_;
  const Callbacks& callbacks_;
  const Clock& clock_;
  std::uint64_t incarnation_;
  std::uint64_t uses_ = 0;
  std::size_t open_payloads_ = 0;
  std::unordered_map<SessionId, std::unique_ptr<SessionIntake>> intakes_;
  std::set<SessionId> dirty_;  // their clients want to hear
  std::vector<Finished> finished_;
  std::function<void()> commit_done_;
  std::atomic<std::size_t> open_sessions_{0};  // as many as intakes_
  DurableBatch running_;                       // what commit_ works on
  std::int64_t running_bytes_ = 0;             // of its files
  CachedFiles cached_;                         // of commit_ alone
  std::atomic<bool> commit_is_done_{false};
  std::future<Status> commit_;  // last: its end is waited for before anything else goes
};

}  // namespace rigcal::dds
