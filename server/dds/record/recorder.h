// Thread W: takes from the inbox, makes it durable in batches, sends the receipts. A receipt means: on disk.
#pragma once

#include <chrono>

#include "server/base/process/vitals.h"
#include "server/dds/intake/inbox.h"
#include "server/dds/intake/last_question.h"
#include "server/dds/record/batch_recorder.h"
#include "server/dds/record/session_recorder.h"

namespace rigcal::dds {

class Recorder {
 public:
  // Its own connections to the store, for this thread and for commits; Options::intake.
  struct Stores {
    storage::Store takes, commits;
    std::string intake;
  };
  // What it works with; all outlive it.
  struct Around {
    Inbox& inbox;
    Outbox& outbox;
    const Callbacks& callbacks;
    const Clock& clock;
    const LastQuestion& asked;
    Part& part;
  };
  // `incarnation` differs for every start of a server.
  Recorder(Stores stores, const Around& around, std::uint64_t incarnation);
  void Run();                                                                       // until the inbox is stopped
  [[nodiscard]] std::size_t OpenSessions() const { return sessions_.CountOpen(); }  // any thread

 private:
  using Time = std::chrono::steady_clock::time_point;
  void Take(Arrival& arrival);
  void TakeOrGiveUp(Arrival& arrival);
  void GiveUp(const Arrival& arrival, const Error& error);
  void Answer(const Refusal& refusal);
  void CarryOut(const Order& order);
  void Keep(const RunsReport& report);
  [[nodiscard]] bool Round();
  [[nodiscard]] Time TakeRound();
  void CommitDue();

  Stores stores_;
  const Around around_;
  std::uint64_t incarnation_;
  SessionRecorder sessions_;
  BatchRecorder batches_;
  Time last_commit_;
};

}  // namespace rigcal::dds
