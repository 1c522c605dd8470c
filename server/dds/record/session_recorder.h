// Sessions from header to closed: manifests, payload files, held bits, receipts. Thread W only.
#pragma once

#include "server/dds/record/session_commit.h"

namespace rigcal::dds {

class SessionRecorder {
 public:
  // All outlive it. `commit_store`: the commits' own connection; `commit_done` is called from their thread. `intake`:
  // Options::intake.
  SessionRecorder(storage::Store& store, storage::Store& commit_store, const std::string& intake, Outbox& outbox,
                  const Callbacks& callbacks, const Clock& clock, std::uint64_t incarnation,
                  std::function<void()> commit_done);

  // The first two are answered at once, by a receipt or a refusal; what became of chunks is told in Report. A chunk of
  // a session that is not open only tells the client where that stands.
  void Take(const OpenSession& open);
  void Take(const ManifestText& text);
  void Take(ChunkBytes& chunk);  // takes its bytes
  void Take(const DiscardedChunk& chunk);

  // After a round of Takes: writes and hashes on all processors.
  void Write();
  // Then: tells the clients how far it is.
  void Report();
  // What is complete, on its way to the store.
  [[nodiscard]] SessionCommits& commits() { return commits_; }
  // Sessions that are being received. Any thread.
  [[nodiscard]] std::size_t CountOpen() const { return sessions_.Count(); }

 private:
  void Tell(const RobotId& robot, const SessionId& session, const Result<wire::ReceiptState>& state);
  [[nodiscard]] SessionIntake* Prepare(const RobotId& robot, const SessionId& session);

  storage::Store& store_;
  const Callbacks& callbacks_;
  const Clock& clock_;
  OpenSessions sessions_;
  SessionReceipts receipts_;
  SessionCommits commits_;  // last: what it has begun is waited for before anything else goes
};

}  // namespace rigcal::dds
