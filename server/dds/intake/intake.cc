#include "server/dds/intake/intake.h"

#include "server/base/process/guarded.h"
#include "server/dds/intake/arrival.h"

namespace rigcal::dds {
namespace {

constexpr std::chrono::milliseconds kIdle{1000};
constexpr int kSmallAtOnce = 256;
constexpr int kEdgesAtOnce = 32;  // each is decomposed and hashed: some 20 us
constexpr int kBigAtOnce = 1;     // a chunk is copied while it is loaned from DDS: a millisecond

}  // namespace

Intake::Intake(Readers readers, wire::NewReaders listeners, wire::WaitSet waitset, Outbox& outbox, Inbox& inbox,
               Part& part)
    : readers_(std::move(readers)),
      listeners_(std::move(listeners)),
      waitset_(std::move(waitset)),
      outbox_(&outbox),
      inbox_(&inbox),
      part_(&part) {}

Result<Intake::Readers> Intake::OpenReaders(const wire::Participant& participant) {
  const std::vector<std::string> robots = {wire::kAllRobotsPartition};
  RIGCAL_ASSIGN(auto headers, wire::Reader<rigcal_wire_SessionHeader>::Open(participant, robots));
  RIGCAL_ASSIGN(auto manifests, wire::Reader<rigcal_wire_Manifest>::Open(participant, robots));
  RIGCAL_ASSIGN(auto edges, wire::Reader<rigcal_wire_PairwiseResult>::Open(participant, robots));
  RIGCAL_ASSIGN(auto chunks, wire::Reader<rigcal_wire_Chunk>::Open(participant, robots));
  RIGCAL_ASSIGN(auto runs, wire::Reader<rigcal_wire_CalibrationInUse>::Open(participant, robots));
  return Readers{std::move(headers), std::move(manifests), std::move(edges), std::move(chunks), std::move(runs)};
}

Result<Intake> Intake::Open(const wire::Participant& participant, Outbox& outbox, Inbox& inbox, Part& part) {
  RIGCAL_ASSIGN(Readers readers, OpenReaders(participant));
  RIGCAL_ASSIGN(wire::NewReaders listeners, wire::NewReaders::Open(participant));
  RIGCAL_ASSIGN(wire::WaitSet waitset, wire::WaitSet::Open(participant));
  for (const dds_entity_t reader : {readers.headers.get(), readers.manifests.get(), readers.edges.get(),
                                    readers.chunks.get(), readers.runs.get(), listeners.get()})
    RIGCAL_TRY(waitset.Attach(reader));
  return Intake(std::move(readers), std::move(listeners), std::move(waitset), outbox, inbox, part);
}

template <typename T>
Result<bool> Intake::TakeInto(wire::Reader<T>& reader, int max) {
  RIGCAL_ASSIGN(const int taken, reader.Take(max, [&](const T& sample, const wire::SampleOrigin& origin) {
    if (auto arrival = FromIdl(sample, origin)) static_cast<void>(inbox_->Offer(std::move(*arrival)));
  }));
  return taken > 0;
}

// One topic that fails keeps none of the others from being taken; its error is the result.
Result<bool> Intake::TakeAll() {
  const Result<bool> taken[] = {TakeInto(readers_.headers, kSmallAtOnce), TakeInto(readers_.manifests, kBigAtOnce),
                                TakeInto(readers_.edges, kEdgesAtOnce), TakeInto(readers_.chunks, kBigAtOnce),
                                TakeInto(readers_.runs, kSmallAtOnce)};
  bool any = false;
  for (const Result<bool>& one : taken) {
    RIGCAL_TRY(one);
    any |= *one;
  }
  return any;
}

// Who may soon push, or listens, reads of its robot first. Who reads of many robots at once is noted as such, whatever
// the wildcard.
Status Intake::MeetRobots() {
  RIGCAL_ASSIGN(const auto partitions, listeners_.TakePartitions(Outbox::Topics()));
  outbox_->NoteReadersOfMany(listeners_.OfMany());
  for (const std::string& partition : partitions)
    if (const auto robot = RobotOfPartition(partition)) outbox_->Meet(*robot);
  outbox_->CloseQuiet();
  return {};
}

// What came is taken also where waiting for it, or looking who is there, failed.
Status Intake::Round() {
  const auto woken = waitset_.Wait(kIdle);
  const Status met = MeetRobots();
  bool any = true;
  while (any && !retry_->Stopped()) {
    RIGCAL_ASSIGN(any, TakeAll());
    if (woken && met) part_->Turn();
  }
  return woken ? met : Fail(woken.error());
}

// What there was no memory to take is sent again, as nobody answered it.
void Intake::Run() {
  while (!retry_->Stopped()) {
    Status done = Guarded([this] { return Round(); });
    if (done) continue;
    part_->Fail(std::move(done).error());
    retry_->Pause();
  }
}

void Intake::Stop() {
  retry_->Stop();
  waitset_.Wake();
}

}  // namespace rigcal::dds
