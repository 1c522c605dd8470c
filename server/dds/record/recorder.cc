#include "server/dds/record/recorder.h"

#include <thread>

#include "server/base/limits.h"
#include "server/base/log.h"
#include "server/base/process/guarded.h"
#include "server/base/process/thread_rank.h"
#include "server/dds/tell/receipts.h"
#include "storage/fleet/robot_runs.h"

namespace rigcal::dds {
namespace {

constexpr std::int64_t kRoundBytes = 8LL << 20;  // small enough that clients hear of progress often
constexpr std::int64_t kRoundWhileAskedBytes = 1LL << 20;
constexpr std::chrono::milliseconds kCommitAfter{20};  // edges may wait so long for more of them
constexpr std::chrono::milliseconds kRecorderIdle{1000};
constexpr std::chrono::milliseconds kAskedLately{200};

std::chrono::nanoseconds DurationOfPayloads(const std::vector<Arrival>& arrivals, std::int64_t bytes_per_s) {
  std::int64_t bytes = 0;
  for (const Arrival& arrival : arrivals)
    if (std::holds_alternative<ChunkBytes>(arrival)) bytes += BytesOf(arrival);
  return std::chrono::nanoseconds(bytes * 1'000'000'000 / bytes_per_s);
}

}  // namespace

Recorder::Recorder(Stores stores, const Around& around, std::uint64_t incarnation)
    : stores_(std::move(stores)),
      around_(around),
      incarnation_(incarnation),
      sessions_(stores_.takes, stores_.commits, stores_.intake, around.outbox, around.callbacks, around.clock,
                incarnation, [this] { around_.inbox.Wake(); }),
      batches_(stores_.takes, around.outbox, around.callbacks, around.clock, incarnation),
      last_commit_(std::chrono::steady_clock::now()) {}

void Recorder::Answer(const Refusal& refusal) {
  LogRefusal({.robot = refusal.partition.str()}, "robot " + refusal.partition.str() + ": refused: ", refusal.error);
  around_.outbox.Send(refusal.partition,
                      RefusalReceipt(refusal.robot, refusal.subject_id, incarnation_, refusal.error));
}

// The answer is given when the change is durable, and work is announced before: who has the answer may count on it.
void Recorder::CarryOut(const Order& order) {
  auto done = around_.callbacks.carry_out(stores_.takes, order.verb, order.json, order.origin);
  if (!done) {
    LogRefusal({.request = order.request}, "order '" + order.verb + "' refused: ", done.error());
    return order.answer(Fail(ToldToClient(done.error())));
  }
  around_.callbacks.work_arrived(done->robot);
  order.answer(std::move(done->document));
}

// What cannot be kept is told again when the robot's program, or this server, starts anew.
void Recorder::Keep(const RunsReport& report) {
  const auto kept = storage::AppendRuns(stores_.takes, report, around_.clock.Now());
  if (!kept) return LogWarn("what robot " + report.robot.str() + " runs was not kept: " + Sentence(kept.error()));
  if (*kept) around_.callbacks.work_arrived(report.robot);  // its summary is to be made anew
}

void Recorder::Take(Arrival& arrival) {
  if (auto* chunk = std::get_if<ChunkBytes>(&arrival)) return sessions_.Take(*chunk);
  if (auto* item = std::get_if<wire::BatchItem>(&arrival)) return batches_.Take(*item);
  if (const auto* open = std::get_if<OpenSession>(&arrival)) return sessions_.Take(*open);
  if (const auto* text = std::get_if<ManifestText>(&arrival)) return sessions_.Take(*text);
  if (const auto* discarded = std::get_if<DiscardedChunk>(&arrival)) return sessions_.Take(*discarded);
  if (const auto* refusal = std::get_if<Refusal>(&arrival)) return Answer(*refusal);
  if (const auto* order = std::get_if<Order>(&arrival)) return CarryOut(*order);
  if (const auto* report = std::get_if<RunsReport>(&arrival)) return Keep(*report);
}

// Whoever sent it is told, and may send it again.
void Recorder::GiveUp(const Arrival& arrival, const Error& error) {
  const auto give_up = [&](const auto& one) { sessions_.commits().GiveUp(one.robot, one.session, error); };
  if (const auto* chunk = std::get_if<ChunkBytes>(&arrival)) return give_up(*chunk);
  if (const auto* open = std::get_if<OpenSession>(&arrival)) return give_up(*open);
  if (const auto* text = std::get_if<ManifestText>(&arrival)) return give_up(*text);
  if (const auto* discarded = std::get_if<DiscardedChunk>(&arrival)) return give_up(*discarded);
  if (const auto* item = std::get_if<wire::BatchItem>(&arrival))
    return batches_.GiveUp(item->edge.robot, item->batch, error);
  if (const auto* order = std::get_if<Order>(&arrival)) return order->answer(Fail(error));
  LogError(error);
}

// What is thrown costs this one, not the others of the round.
void Recorder::TakeOrGiveUp(Arrival& arrival) {
  const Status taken = Guarded([&]() -> Status {
    Take(arrival);
    return {};
  });
  if (taken) return;
  const Status told = Guarded([&]() -> Status {
    OnceThereIsMemory([&] { GiveUp(arrival, taken.error()); });
    return {};
  });
  if (!told) LogError(told.error());
}

// While somebody asks, one robot's flood leaves processors and disk to the answers: the next round begins no earlier
// than at the time that this gives.
Recorder::Time Recorder::TakeRound() {
  const Time start = std::chrono::steady_clock::now();
  const bool yields = around_.asked.IsWithin(kAskedLately);
  auto arrivals = around_.inbox.Take(yields ? kRoundWhileAskedBytes : kRoundBytes, kRecorderIdle);
  const auto least = DurationOfPayloads(arrivals, limits::kIntakeWhileAskedBytesPerS);
  for (Arrival& arrival : arrivals) TakeOrGiveUp(arrival);
  sessions_.Write();
  around_.inbox.Release();  // before clients are told that they may send more
  sessions_.Report();
  return yields ? start + least : start;
}

void Recorder::CommitDue() {
  sessions_.commits().CommitDue();
  const auto now = std::chrono::steady_clock::now();
  if (!batches_.HasPending() || (!around_.inbox.Empty() && now - last_commit_ < kCommitAfter)) return;
  batches_.Commit();
  last_commit_ = now;
}

bool Recorder::Round() {
  if (around_.inbox.Stopped()) return false;
  const Time next = TakeRound();
  CommitDue();
  around_.part.Turn();
  std::this_thread::sleep_until(next);
  return true;
}

void Recorder::Run() {
  SetThreadRank(ThreadRank::kStores);
  GoRound(&around_.part, [this] { return Round(); });
  OnceThereIsMemory([this] { sessions_.commits().Settle(); });
}

}  // namespace rigcal::dds
