// Thread D: takes everything at once and never waits for anyone, as a reader that stops taking stalls every topic of
// the process. Checks samples (arrival.h) and hands them to thread W.
#pragma once

#include <memory>

#include "idl/discovery.h"
#include "server/base/process/vitals.h"
#include "server/dds/intake/inbox.h"
#include "server/dds/intake/retry.h"
#include "server/dds/tell/outbox.h"

namespace rigcal::dds {

class Intake {
 public:
  // Outbox, inbox and part, which is told of every failure, outlive it.
  [[nodiscard]] static Result<Intake> Open(const wire::Participant& participant, Outbox& outbox, Inbox& inbox,
                                           Part& part);
  void Run();   // until Stop
  void Stop();  // any thread

 private:
  struct Readers {
    wire::Reader<rigcal_wire_SessionHeader> headers;
    wire::Reader<rigcal_wire_Manifest> manifests;
    wire::Reader<rigcal_wire_PairwiseResult> edges;
    wire::Reader<rigcal_wire_Chunk> chunks;
    wire::Reader<rigcal_wire_CalibrationInUse> runs;
  };
  Intake(Readers readers, wire::NewReaders listeners, wire::WaitSet waitset, Outbox& outbox, Inbox& inbox, Part& part);

  [[nodiscard]] static Result<Readers> OpenReaders(const wire::Participant& participant);
  [[nodiscard]] Status Round();          // waits, then takes until there is nothing left
  [[nodiscard]] Result<bool> TakeAll();  // true if there was something
  template <typename T>
  [[nodiscard]] Result<bool> TakeInto(wire::Reader<T>& reader, int max);
  [[nodiscard]] Status MeetRobots();

  Readers readers_;
  wire::NewReaders listeners_;
  wire::WaitSet waitset_;
  Outbox* outbox_;
  Inbox* inbox_;
  Part* part_;
  std::unique_ptr<Retry> retry_ = std::make_unique<Retry>();
};

}  // namespace rigcal::dds
