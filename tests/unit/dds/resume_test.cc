// Interrupted transfers: the server restarts, the client comes back, the intake is full.
#include <gmock/gmock.h>

#include "server/base/limits.h"
#include "storage/sessions/sessions.h"
#include "tests/unit/dds/fixture.h"

namespace rigcal::dds {
namespace {

using wire::Receipt;
using wire::ReceiptState;

using ResumeTest = ServiceTest;

TEST_F(ResumeTest, AfterARestartOnlyWhatIsNotHeldIsSentAgain) {
  const Session session = MakeSession("mapper-01", {50'000, 60'000, 70'000}, 1);
  std::uint64_t incarnation = 0;
  {
    Client client = MakeClient("mapper-01");
    client.SendManifest(session);
    incarnation = client.AwaitState(session.id.str(), ReceiptState::kReceiving).incarnation;
    client.SendPayload(session, 1);
    client.Await(session.id.str(), [](const Receipt& receipt) { return receipt.held.size() > 1 && receipt.held[1]; });
    client.SendChunk(session, 0, 0, std::string_view(session.payloads[0]).substr(0, 30'000));  // half of one
    client.Await(session.id.str(), [](const Receipt& receipt) { return receipt.written_bytes == 90'000; });
  }
  StopServer();
  StartServer();
  Client client = MakeClient("mapper-01");
  client.SendHeader(session);
  const Receipt receiving = client.AwaitState(session.id.str(), ReceiptState::kReceiving);
  EXPECT_NE(receiving.incarnation, incarnation);
  EXPECT_EQ(receiving.written_bytes, 0u);
  EXPECT_TRUE(receiving.held[1]);
  EXPECT_FALSE(receiving.held[0] || receiving.held[2]);
  client.SendPayload(session, 0);
  client.SendPayload(session, 2);
  client.AwaitState(session.id.str(), ReceiptState::kClosed);
}

TEST_F(ResumeTest, AChunkWithoutAHeaderIsEnough) {
  const Session session = MakeSession("mapper-01", {1'000, 2'000}, 10);
  Client client = MakeClient("mapper-01");
  client.SendPayload(session, 0);  // unknown session: the manifest is asked for
  client.AwaitState(session.id.str(), ReceiptState::kNeedManifest);
  client.SendManifest(session);
  client.AwaitState(session.id.str(), ReceiptState::kReceiving);
  StopServer();
  StartServer();
  Client again = MakeClient("mapper-01");
  again.SendPayload(session, 0);  // known to the store: received at once
  again.SendPayload(session, 1);
  again.AwaitState(session.id.str(), ReceiptState::kClosed);
}

TEST_F(ResumeTest, RemnantsOfTheIntakeAreRemovedAtStart) {
  StopServer();
  const auto remnant = folder_.path() / "intake" / std::string(64, 'f');
  std::filesystem::create_directories(remnant);
  StartServer();
  EXPECT_FALSE(std::filesystem::exists(remnant));
}

// More sessions than may be open: the oldest is forgotten, told apart by its incarnation, and can still be finished.
TEST_F(ResumeTest, AForgottenSessionStartsOverFromWhatIsHeld) {
  Client client = MakeClient("mapper-01");
  const Session first = MakeSession("mapper-01", {5'000, 6'000}, 1'000);
  client.SendManifest(first);
  const Receipt before = client.AwaitState(first.id.str(), ReceiptState::kReceiving);
  client.SendPayload(first, 0);
  client.Await(first.id.str(), [](const Receipt& receipt) { return receipt.held[0]; });
  for (unsigned i = 0; i <= limits::kOpenSessionsMax; ++i) {
    const Session other = MakeSession("mapper-01", {500}, 2'000 + i);
    client.SendManifest(other);
    client.AwaitState(other.id.str(), ReceiptState::kReceiving);
  }
  client.SendHeader(first);
  const Receipt after = client.Await(first.id.str(), [&](const Receipt& receipt) {
    return receipt.sequence_number > before.sequence_number && receipt.incarnation != before.incarnation;
  });
  EXPECT_TRUE(after.held[0]);
  client.SendPayload(first, 1);
  client.AwaitState(first.id.str(), ReceiptState::kClosed);
}

// A client that ignores the window loses chunks, is told which, and gets through by sending those again.
TEST_F(ResumeTest, WhatIsDiscardedIsListedUntilItComesAgain) {
  constexpr std::size_t kChunks = 160;
  const Session session = MakeSession("mapper-01", {kChunks << 20}, 3'000);
  Client client = MakeClient("mapper-01");
  client.SendManifest(session);
  client.AwaitState(session.id.str(), ReceiptState::kReceiving);
  const auto send = [&](std::uint64_t offset) {
    const auto bytes = std::string_view(session.payloads[0]).substr(offset, 1 << 20);
    Status sent = client.TrySendChunk(session, 0, offset, bytes);
    while (!sent && sent.error().code == ErrorCode::kBusy) sent = client.TrySendChunk(session, 0, offset, bytes);
    Must(sent);
  };
  for (std::size_t i = 0; i < kChunks; ++i) send(i << 20);
  std::size_t discarded = 0;
  std::uint64_t seen = 0;
  ReceiptState state = ReceiptState::kReceiving;
  while (state != ReceiptState::kClosed) {
    client.SendHeader(session);
    const Receipt receipt =
        client.Await(session.id.str(), [&](const Receipt& one) { return one.sequence_number > seen; });
    seen = receipt.sequence_number;
    state = receipt.state;
    discarded += receipt.busy.size();
    for (const auto& at : receipt.busy) send(at.offset_bytes);
  }
  RecordProperty("discarded", static_cast<int>(discarded));
  storage::Store store = Must(storage::Store::Open(folder_.path()));
  EXPECT_TRUE(Must(storage::LoadSession(store, session.id))->closed);
}

}  // namespace
}  // namespace rigcal::dds
