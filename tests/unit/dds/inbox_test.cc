#include "server/dds/intake/inbox.h"

#include <gtest/gtest.h>

#include <thread>

#include "server/dds/intake/last_question.h"

namespace rigcal::dds {
namespace {

using std::chrono::milliseconds;
const SessionId kA(std::string(64, 'a')), kB(std::string(64, 'b'));
constexpr Inbox::Limits kLimits{10'000, 25'000, 100};

ChunkBytes ChunkOf(const SessionId& session, std::uint32_t idx, std::size_t size_bytes) {
  return {RobotId("r"), session, idx, 0, std::string(size_bytes, 'x')};
}

std::vector<std::string> Kinds(const std::vector<Arrival>& arrivals) {
  std::vector<std::string> kinds;
  for (const Arrival& one : arrivals) {
    if (const auto* chunk = std::get_if<ChunkBytes>(&one))
      kinds.push_back("chunk " + std::to_string(chunk->payload_idx));
    if (const auto* gone = std::get_if<DiscardedChunk>(&one))
      kinds.push_back("discarded " + std::to_string(gone->payload_idx));
    if (std::holds_alternative<OpenSession>(one)) kinds.push_back("open");
  }
  return kinds;
}

TEST(LastQuestion, IsLateOnlyAfterItWasAsked) {
  LastQuestion asked;
  EXPECT_FALSE(asked.IsWithin(std::chrono::minutes(59)));
  asked.Note();
  EXPECT_TRUE(asked.IsWithin(std::chrono::minutes(59)));
  EXPECT_FALSE(asked.IsWithin(std::chrono::milliseconds(0)));
}

TEST(Inbox, DiscardsWhatIsBeyondASessionsWindowAndSaysSo) {
  Inbox inbox(kLimits);
  EXPECT_TRUE(inbox.Offer(ChunkOf(kA, 0, 6'000)));
  EXPECT_FALSE(inbox.Offer(ChunkOf(kA, 1, 6'000)));
  EXPECT_TRUE(inbox.Offer(ChunkOf(kB, 2, 6'000)));  // another session has its own
  EXPECT_EQ(Kinds(inbox.Take(1'000'000, milliseconds(0))),
            (std::vector<std::string>{"chunk 0", "discarded 1", "chunk 2"}));
}

TEST(Inbox, WhatWasTakenCountsUntilItIsReleased) {
  Inbox inbox(kLimits);
  EXPECT_TRUE(inbox.Offer(ChunkOf(kA, 0, 10'000)));
  ASSERT_EQ(inbox.Take(1'000'000, milliseconds(0)).size(), 1u);
  EXPECT_FALSE(inbox.Offer(ChunkOf(kA, 1, 10'000)));
  inbox.Release();
  EXPECT_TRUE(inbox.Offer(ChunkOf(kA, 2, 10'000)));
}

TEST(Inbox, WhoCanWaitGetsRoomOnceThereIsSome) {
  Inbox inbox(kLimits);
  EXPECT_TRUE(inbox.OfferWithin(ChunkOf(kA, 0, 10'000), milliseconds(0)));
  EXPECT_FALSE(inbox.OfferWithin(ChunkOf(kA, 1, 10'000), milliseconds(1))) << "and nothing is put in its place";
  EXPECT_EQ(Kinds(inbox.Take(1'000'000, milliseconds(0))), (std::vector<std::string>{"chunk 0"}));
  std::thread waits([&] { EXPECT_TRUE(inbox.OfferWithin(ChunkOf(kA, 2, 10'000), milliseconds(60'000))); });
  inbox.Release();
  waits.join();
  EXPECT_EQ(Kinds(inbox.Take(1'000'000, milliseconds(0))), (std::vector<std::string>{"chunk 2"}));
  std::thread stopped([&] { EXPECT_FALSE(inbox.OfferWithin(ChunkOf(kA, 3, 10'000), milliseconds(60'000))); });
  inbox.Stop();
  stopped.join();
}

TEST(Inbox, TellsWhatCountsAgainstItsLimits) {
  Inbox inbox(kLimits);
  EXPECT_EQ(inbox.Look().bytes, 0);
  EXPECT_EQ(inbox.Look().bytes_max, kLimits.all_bytes);
  EXPECT_TRUE(inbox.Offer(ChunkOf(kA, 0, 5'000)));
  EXPECT_TRUE(inbox.Offer(ChunkOf(kB, 0, 5'000)));
  const std::int64_t both = inbox.Look().bytes;
  EXPECT_GE(both, 10'000);
  EXPECT_EQ(inbox.Look().arrivals, 2u);
  ASSERT_EQ(inbox.Take(1'000'000, milliseconds(0)).size(), 2u);
  EXPECT_EQ(inbox.Look().bytes, both) << "what was taken is not on disk yet";
  EXPECT_EQ(inbox.Look().arrivals, 0u);
  inbox.Release();
  EXPECT_EQ(inbox.Look().bytes, 0);
}

TEST(Inbox, AllSessionsTogetherAreBounded) {
  Inbox inbox(kLimits);
  int taken = 0;
  for (char name = 'a'; name <= 'f'; ++name)
    taken += inbox.Offer(ChunkOf(SessionId(std::string(64, name)), 0, 9'000)) ? 1 : 0;
  EXPECT_EQ(taken, 2);
}

TEST(Inbox, TakesInOrderAndAboutAsMuchAsAsked) {
  Inbox inbox(kLimits);
  for (std::uint32_t i = 0; i < 3; ++i) EXPECT_TRUE(inbox.Offer(ChunkOf(kA, i, 3'000)));
  EXPECT_TRUE(inbox.Offer(OpenSession{RobotId("r"), kA, 1}));
  EXPECT_EQ(Kinds(inbox.Take(4'000, milliseconds(0))), (std::vector<std::string>{"chunk 0", "chunk 1"}));
  EXPECT_EQ(Kinds(inbox.Take(1'000'000, milliseconds(0))), (std::vector<std::string>{"chunk 2", "open"}));
  EXPECT_TRUE(inbox.Empty());
}

TEST(Inbox, IsBoundedInNumber) {
  Inbox inbox(kLimits);
  for (int i = 0; i < 1'000; ++i) static_cast<void>(inbox.Offer(OpenSession{RobotId("r"), kA, 1}));
  EXPECT_LE(inbox.Take(1'000'000, milliseconds(0)).size(), kLimits.items);
}

TEST(Inbox, WakeAndStopEndATake) {
  Inbox inbox(kLimits);
  std::thread waker([&] { inbox.Wake(); });
  EXPECT_TRUE(inbox.Take(1, milliseconds(10'000)).empty());
  waker.join();
  std::thread stopper([&] { inbox.Stop(); });
  EXPECT_TRUE(inbox.Take(1, milliseconds(10'000)).empty());
  stopper.join();
  EXPECT_TRUE(inbox.Stopped());
}

}  // namespace
}  // namespace rigcal::dds
