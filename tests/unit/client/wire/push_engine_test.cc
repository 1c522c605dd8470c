#include "client/wire/push_engine.h"

#include <gtest/gtest.h>

#include <numeric>

namespace rigcal::client {
namespace {

using Kind = PushAction::Kind;
using State = wire::ReceiptState;

constexpr std::int64_t kMs_ns = 1'000'000, kSecond_ns = 1'000'000'000;

PushPlan Plan(std::vector<std::int64_t> payload_bytes) {
  PushPlan plan;
  plan.payload_bytes = std::move(payload_bytes);
  plan.chunk_bytes = 10;
  return plan;
}

wire::Receipt ReceiptOf(State state, std::uint64_t sequence_number, std::vector<bool> held = {}) {
  wire::Receipt receipt;
  receipt.state = state;
  receipt.incarnation = 7;
  receipt.sequence_number = sequence_number;
  receipt.window_bytes = 1000;
  receipt.held = std::move(held);
  return receipt;
}

// All chunks that may go out now, as (payload, offset).
std::vector<std::pair<int, int>> Chunks(PushEngine& engine, std::int64_t now_ns) {
  std::vector<std::pair<int, int>> chunks;
  for (PushAction action = engine.Next(now_ns); action.kind == Kind::kSendChunk; action = engine.Next(now_ns))
    chunks.emplace_back(action.chunk.payload_idx, action.chunk.offset_bytes);
  return chunks;
}

using Pairs = std::vector<std::pair<int, int>>;

// An engine that was answered "receiving" at time 0.
PushEngine Receiving(const PushPlan& plan, const wire::Receipt& receipt) {
  PushEngine engine(plan, 0);
  EXPECT_EQ(engine.Next(0).kind, Kind::kSendHeader);
  engine.OnReceipt(receipt, 0);
  return engine;
}

TEST(PushEngine, HeaderThenManifestThenChunksThenClosed) {
  PushEngine engine(Plan({25, 5}), 0);
  EXPECT_EQ(engine.Next(0).kind, Kind::kSendHeader);
  EXPECT_EQ(engine.Next(1).kind, Kind::kWait);
  engine.OnReceipt(ReceiptOf(State::kNeedManifest, 1), 2);
  EXPECT_EQ(engine.Next(3).kind, Kind::kSendManifest);
  EXPECT_EQ(engine.Next(4).kind, Kind::kWait);
  engine.OnReceipt(ReceiptOf(State::kReceiving, 2, {false, false}), 5);
  EXPECT_EQ(Chunks(engine, 6), (Pairs{{0, 0}, {0, 10}, {0, 20}, {1, 0}}));
  EXPECT_EQ(engine.chunks().InFlightBytes(), 30);
  engine.OnReceipt(ReceiptOf(State::kReceiving, 3, {true, false}), 7);
  EXPECT_EQ(engine.chunks().counts().held_bytes, 25);
  engine.OnReceipt(ReceiptOf(State::kClosed, 4, {true, true}), 8);
  EXPECT_EQ(engine.Next(9).kind, Kind::kClosed);
  EXPECT_EQ(engine.talk().state, State::kClosed);
}

TEST(PushEngine, ResumeSendsOnlyWhatIsNotHeld) {
  PushEngine engine = Receiving(Plan({10, 20, 10}), ReceiptOf(State::kReceiving, 5, {true, false, true}));
  EXPECT_EQ(engine.chunks().counts().held_at_first_bytes, 20);
  EXPECT_EQ(Chunks(engine, 1), (Pairs{{1, 0}, {1, 10}}));
}

TEST(PushEngine, TheLastChunkOfAPayloadIsShort) {
  PushEngine engine = Receiving(Plan({25}), ReceiptOf(State::kReceiving, 1));
  EXPECT_EQ(engine.Next(1).chunk.size_bytes, 10U);
  EXPECT_EQ(engine.Next(1).chunk.size_bytes, 10U);
  EXPECT_EQ(engine.Next(1).chunk.size_bytes, 5U);
  EXPECT_EQ(engine.Next(1).kind, Kind::kWait);
}

TEST(PushEngine, KeepsToTheWindowAndGoesOnWhenBytesAreWritten) {
  wire::Receipt receipt = ReceiptOf(State::kReceiving, 1);
  receipt.window_bytes = 25;
  receipt.written_bytes = 1'000'000;  // of a client before this one
  PushEngine engine = Receiving(Plan({100}), receipt);
  EXPECT_EQ(Chunks(engine, 1).size(), 2U);
  receipt.sequence_number = 2;
  receipt.written_bytes += 10;
  engine.OnReceipt(receipt, 2);
  EXPECT_EQ(Chunks(engine, 3), (Pairs{{0, 20}}));
  EXPECT_EQ(engine.chunks().InFlightBytes(), 20);
  EXPECT_EQ(engine.chunks().ArrivedBytes(), 10);
}

TEST(PushEngine, BusyChunksGoAgainAfterAPauseAndOnlyOnce) {
  PushEngine engine = Receiving(Plan({40}), ReceiptOf(State::kReceiving, 1));
  EXPECT_EQ(Chunks(engine, 1).size(), 4U);
  wire::Receipt busy = ReceiptOf(State::kReceiving, 2);
  busy.busy = {{0, 10}, {0, 30}, {9, 0}, {0, 4000}};  // two are none of ours
  engine.OnReceipt(busy, 2);
  EXPECT_EQ(engine.chunks().InFlightBytes(), 20);
  EXPECT_EQ(engine.Next(3).kind, Kind::kWait);
  EXPECT_EQ(Chunks(engine, 20 * kMs_ns), (Pairs{{0, 10}, {0, 30}}));
  busy.sequence_number = 3;  // still listed: the server has not seen them again yet
  engine.OnReceipt(busy, 21 * kMs_ns);
  EXPECT_EQ(Chunks(engine, 100 * kMs_ns), Pairs{});
  busy.sequence_number = 4;  // listed for so long: they were discarded once more
  engine.OnReceipt(busy, 700 * kMs_ns);
  EXPECT_EQ(Chunks(engine, 1200 * kMs_ns), (Pairs{{0, 10}, {0, 30}}));
}

TEST(PushEngine, ANewIncarnationGetsAllThatItDoesNotHold) {
  PushEngine engine = Receiving(Plan({10, 10, 10}), ReceiptOf(State::kReceiving, 8, {true, false, false}));
  EXPECT_EQ(Chunks(engine, 1).size(), 2U);
  wire::Receipt restarted = ReceiptOf(State::kReceiving, 1, {true, false, true});  // numbers begin anew
  restarted.incarnation = 3;
  engine.OnReceipt(restarted, 2);
  EXPECT_EQ(engine.restarts(), 1);
  EXPECT_EQ(Chunks(engine, 3), (Pairs{{1, 0}}));
  engine.OnReceipt(ReceiptOf(State::kClosed, 99, {true, true, true}), 4);  // late, of the server that is gone
  EXPECT_NE(engine.talk().state, State::kClosed);
}

TEST(PushEngine, ANewServerWithAnEmptyDiskGetsEverything) {
  PushEngine engine = Receiving(Plan({10, 10}), ReceiptOf(State::kReceiving, 8, {true, false}));
  wire::Receipt restarted = ReceiptOf(State::kNeedManifest, 1);
  restarted.incarnation = 3;
  engine.OnReceipt(restarted, 2);
  EXPECT_EQ(engine.Next(3).kind, Kind::kSendManifest);
  restarted.state = State::kReceiving;
  restarted.sequence_number = 2;
  engine.OnReceipt(restarted, 4);
  EXPECT_EQ(Chunks(engine, 5), (Pairs{{0, 0}, {1, 0}}));
}

TEST(PushEngine, OlderReceiptsAreIgnored) {
  PushEngine engine = Receiving(Plan({10, 10}), ReceiptOf(State::kReceiving, 8, {true, true}));
  engine.OnReceipt(ReceiptOf(State::kNeedManifest, 3), 1);
  EXPECT_EQ(engine.Next(2).kind, Kind::kWait);
  EXPECT_EQ(engine.chunks().counts().payloads_held, 2U);
}

TEST(PushEngine, RefusalOfTheServerEndsIt) {
  PushEngine engine = Receiving(Plan({10}), ReceiptOf(State::kReceiving, 1));
  wire::Receipt refusal = ReceiptOf(State::kRefused, 2);
  refusal.error = Error{ErrorCode::kConflict, "sensor 'left' is listed twice", "Mend session.yaml"};
  engine.OnReceipt(refusal, 1);
  EXPECT_EQ(engine.Next(2).kind, Kind::kRefused);
  EXPECT_EQ(engine.talk().error->what, "sensor 'left' is listed twice");
}

TEST(PushEngine, ARefusalOfAnEarlierTryIsAskedAgain) {
  PushEngine engine(Plan({10}), 0);
  EXPECT_EQ(engine.Next(0).kind, Kind::kSendHeader);
  engine.OnReceipt(ReceiptOf(State::kRefused, 5), 1);
  EXPECT_EQ(engine.Next(2).kind, Kind::kWait);
  EXPECT_EQ(engine.Next(kSecond_ns).kind, Kind::kSendHeader);
  PushEngine mended = engine;
  mended.OnReceipt(ReceiptOf(State::kReceiving, 6), kSecond_ns + 1);
  EXPECT_EQ(mended.Next(kSecond_ns + 2).kind, Kind::kSendChunk);
  engine.OnReceipt(ReceiptOf(State::kRefused, 6), kSecond_ns + 1);
  EXPECT_EQ(engine.Next(kSecond_ns + 2).kind, Kind::kRefused);
}

// It is that of an earlier push: another session may have superseded this one since, so the server is to hear of it.
TEST(PushEngine, AnEndOfAnEarlierPushIsAskedAgain) {
  for (const bool is_asked : {false, true}) {
    PushEngine engine(Plan({10}), 0);
    if (is_asked) {
      EXPECT_EQ(engine.Next(0).kind, Kind::kSendHeader);
    }
    engine.OnReceipt(ReceiptOf(State::kClosed, 5, {true}), 1);
    EXPECT_EQ(engine.Next(2).kind, Kind::kSendHeader);
    EXPECT_EQ(engine.Next(3).kind, Kind::kWait);
    engine.OnReceipt(ReceiptOf(State::kClosed, 6, {true}), 4);
    EXPECT_EQ(engine.Next(5).kind, Kind::kClosed);
    EXPECT_EQ(engine.chunks().counts().held_at_first_bytes, 10);
  }
}

TEST(PushEngine, AsksAgainAfterSilenceAndGivesUp) {
  PushPlan plan = Plan({10});
  plan.give_up_ns = 10 * kSecond_ns;
  PushEngine engine = Receiving(plan, ReceiptOf(State::kReceiving, 1));
  EXPECT_EQ(Chunks(engine, 1).size(), 1U);
  std::vector<std::int64_t> asked_ms;
  std::int64_t now_ns = 2;
  for (PushAction action = engine.Next(now_ns); action.kind != Kind::kGaveUp; action = engine.Next(now_ns)) {
    if (action.kind == Kind::kSendHeader) asked_ms.push_back(now_ns / kMs_ns);
    if (action.kind == Kind::kWait) now_ns = action.until_ns;
    ASSERT_LE(now_ns, 20 * kSecond_ns);
  }
  EXPECT_EQ(asked_ms, (std::vector<std::int64_t>{1000, 2000, 3000, 4000, 5000, 6000, 7000, 8000, 9000}));
  EXPECT_EQ(now_ns, 10 * kSecond_ns);
}

TEST(PushEngine, WaitsAreNeverInThePast) {
  PushEngine engine = Receiving(Plan({10}), ReceiptOf(State::kReceiving, 1));
  for (std::int64_t now_ns = 1; now_ns < 5 * kSecond_ns; now_ns += 37 * kMs_ns) {
    const PushAction action = engine.Next(now_ns);
    if (action.kind == Kind::kWait) {
      EXPECT_GT(action.until_ns, now_ns);
    }
  }
}

TEST(PushEngine, AnswersWithoutProgressMeanThatChunksWereLost) {
  PushEngine engine = Receiving(Plan({10, 10}), ReceiptOf(State::kReceiving, 1, {false, false}));
  EXPECT_EQ(Chunks(engine, 1).size(), 2U);
  std::size_t again = 0;
  for (std::uint64_t second = 1; second <= 6 && again == 0; ++second) {
    const std::int64_t now_ns = static_cast<std::int64_t>(second) * (kSecond_ns + 10);
    EXPECT_EQ(engine.Next(now_ns).kind, Kind::kSendHeader);
    engine.OnReceipt(ReceiptOf(State::kReceiving, 1 + second, {false, false}), now_ns + 1);
    again = Chunks(engine, now_ns + 2).size();
    EXPECT_TRUE(again == 0 || second == 5);
  }
  EXPECT_EQ(again, 2U);
}

TEST(PushEngine, SilenceIsNotTakenForLostChunks) {
  PushEngine engine = Receiving(Plan({10}), ReceiptOf(State::kReceiving, 1));
  EXPECT_EQ(Chunks(engine, 1).size(), 1U);
  for (std::int64_t second = 1; second < 30; ++second) {
    EXPECT_EQ(engine.Next(second * kSecond_ns + 5).kind, Kind::kSendHeader);
    EXPECT_EQ(engine.Next(second * kSecond_ns + 6).kind, Kind::kWait);
  }
}

TEST(PushEngine, ALastingComplaintAboutAPayloadEndsIt) {
  PushEngine engine = Receiving(Plan({10}), ReceiptOf(State::kReceiving, 1));
  int sends = 0;
  std::uint64_t number = 1;
  std::int64_t now_ns = 1;
  PushAction action = engine.Next(now_ns);
  for (; action.kind != Kind::kRefused; action = engine.Next(now_ns)) {
    ASSERT_LT(now_ns, 60 * kSecond_ns);
    if (action.kind == Kind::kWait) now_ns = action.until_ns;
    if (action.kind == Kind::kSendManifest) FAIL();
    if (action.kind != Kind::kSendHeader && action.kind != Kind::kSendChunk) continue;
    sends += action.kind == Kind::kSendChunk ? 1 : 0;
    wire::Receipt complaint = ReceiptOf(State::kReceiving, ++number);
    complaint.written_bytes = static_cast<std::uint64_t>(10 * sends);
    complaint.error = Error{ErrorCode::kConflict, "left/01.png has another hash", ""};
    engine.OnReceipt(complaint, ++now_ns);
  }
  EXPECT_EQ(sends, 2);
  EXPECT_EQ(engine.talk().error->what, "left/01.png has another hash");
}

TEST(PushEngine, WhatDdsDidNotTakeIsGivenAgain) {
  PushEngine engine = Receiving(Plan({20}), ReceiptOf(State::kReceiving, 1));
  const PushAction first = engine.Next(1);
  ASSERT_EQ(first.kind, Kind::kSendChunk);
  engine.NotSent(first.chunk);
  EXPECT_EQ(engine.chunks().InFlightBytes(), 0);
  EXPECT_EQ(Chunks(engine, 2).size(), 2U);
}

TEST(PushEngine, HeldBitsBeyondTheSessionAreIgnored) {
  PushEngine engine =
      Receiving(Plan({10}), ReceiptOf(State::kReceiving, 1, {false, true, true, true, true, true, true, true}));
  EXPECT_EQ(engine.chunks().counts().held_bytes, 0);
  EXPECT_EQ(Chunks(engine, 1).size(), 1U);
}

TEST(BatchPlan, OneProbeThenAsManyInFlightAsAllowedInTheGivenOrder) {
  PushPlan plan = BatchPlan(6, 3);
  plan.send_order = {5, 3, 1, 0, 2, 4};
  PushEngine engine(plan, 0);
  EXPECT_EQ(engine.Next(0).kind, Kind::kSendHeader);
  EXPECT_EQ(ProbeItem(engine.chunks()), 0U);
  EXPECT_EQ(engine.Next(1).kind, Kind::kWait);
  engine.OnReceipt(ReceiptOf(State::kReceiving, 1, {true, false, false, false, false, false}), 2);
  EXPECT_EQ(Chunks(engine, 3), (Pairs{{5, 0}, {3, 0}, {1, 0}}));
  engine.OnReceipt(ReceiptOf(State::kReceiving, 2, {true, true, false, true, false, false}), 4);
  EXPECT_EQ(Chunks(engine, 5), (Pairs{{2, 0}, {4, 0}}));
  EXPECT_EQ(engine.chunks().InFlightBytes(), 3);
  engine.OnReceipt(ReceiptOf(State::kClosed, 3, std::vector<bool>(6, true)), 6);
  EXPECT_EQ(engine.Next(7).kind, Kind::kClosed);
}

TEST(BatchPlan, PushingTwiceSendsOneProbeOnly) {
  PushEngine engine(BatchPlan(4, 2000), 0);
  EXPECT_EQ(engine.Next(0).kind, Kind::kSendHeader);
  engine.OnReceipt(ReceiptOf(State::kClosed, 1, std::vector<bool>(4, true)), 1);
  EXPECT_EQ(engine.Next(2).kind, Kind::kClosed);
  EXPECT_EQ(engine.chunks().counts().held_at_first_bytes, 4);
}

}  // namespace
}  // namespace rigcal::client
