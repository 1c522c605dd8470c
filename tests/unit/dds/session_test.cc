// Sessions over real DDS: server and clients in this process.
#include <gmock/gmock.h>

#include <fstream>

#include "server/base/limits.h"
#include "storage/files/blobs.h"
#include "storage/sessions/sessions.h"
#include "storage/sessions/standing.h"
#include "storage/work/jobs.h"
#include "tests/unit/dds/fixture.h"

namespace rigcal::dds {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using wire::Receipt;
using wire::ReceiptState;

class SessionTest : public ServiceTest {
 protected:
  // What a receipt promised is in the store.
  void ExpectStored(const Session& session) {
    storage::Store store = Must(storage::Store::Open(folder_.path()));
    const auto row = Must(storage::LoadSession(store, session.id));
    ASSERT_TRUE(row);
    EXPECT_TRUE(row->closed);
    EXPECT_EQ(row->robot, session.robot);
    for (const std::string& bytes : session.payloads)
      EXPECT_EQ(Must(storage::LoadBlob(store.BlobFolder(), Sha256Of(std::string_view(bytes)), 1 << 24)), bytes);
  }
  // The one session of the robot that no other supersedes.
  SessionId CurrentOf(const RobotId& robot) {
    storage::Store store = Must(storage::Store::Open(folder_.path()));
    const auto superseded = Must(storage::LoadSuperseded(store, robot));
    auto rows = Must(storage::LoadSessions(store, robot));
    std::erase_if(rows, [&](const auto& row) { return superseded.contains(row.id); });
    EXPECT_EQ(rows.size(), 1u);
    return rows.empty() ? SessionId() : rows.front().id;
  }
  static bool Holds(const Receipt& receipt, std::size_t count) {
    std::size_t held = 0;
    for (const bool bit : receipt.held) held += bit ? 1 : 0;
    return held == count;
  }
  std::size_t IntakeEntries() {
    const auto folder = Must(storage::Store::Open(folder_.path())).IntakeFolder();
    return static_cast<std::size_t>(
        std::distance(std::filesystem::directory_iterator(folder), std::filesystem::directory_iterator()));
  }
};

TEST_F(SessionTest, PushesASessionAndPushingAgainIsANoOp) {
  const Session session = MakeSession("mapper-01", {1'000, 250'000, 1}, 1);
  Client client = MakeClient("mapper-01");
  const Receipt closed = client.Push(session);
  EXPECT_TRUE(Holds(closed, 3));
  ExpectStored(session);
  EXPECT_THAT(Work(), ElementsAre(session.robot));
  EXPECT_EQ(IntakeEntries(), 0u);
  client.SendHeader(session);
  const Receipt again = client.Await(
      session.id.str(), [&](const Receipt& receipt) { return receipt.sequence_number > closed.sequence_number; });
  EXPECT_EQ(again.state, ReceiptState::kClosed);
  EXPECT_TRUE(Holds(again, 3));
  EXPECT_EQ(Work().size(), 1u);
}

TEST_F(SessionTest, ALateJoinerSeesTheNewestReceipt) {
  const Session session = MakeSession("mapper-01", {1'000}, 2);
  MakeClient("mapper-01").Push(session);
  Client late = MakeClient("mapper-01");
  late.AwaitState(session.id.str(), ReceiptState::kClosed);  // without asking
}

TEST_F(SessionTest, ChunksMayComeInAnyOrderAndTwice) {
  const Session session = MakeSession("mapper-01", {300'000, 5'000}, 3);
  Client client = MakeClient("mapper-01");
  client.SendHeader(session);
  client.AwaitState(session.id.str(), ReceiptState::kNeedManifest);
  client.SendManifest(session);
  client.AwaitState(session.id.str(), ReceiptState::kReceiving);
  const std::string_view first = session.payloads[0];
  client.SendChunk(session, 0, 200'000, first.substr(200'000));
  client.SendPayload(session, 1);
  client.SendChunk(session, 0, 0, first.substr(0, 120'000));
  client.SendChunk(session, 0, 0, first.substr(0, 120'000));
  client.SendPayload(session, 1);
  client.SendChunk(session, 0, 100'000, first.substr(100'000, 150'000));
  client.AwaitState(session.id.str(), ReceiptState::kClosed);
  ExpectStored(session);
}

TEST_F(SessionTest, EveryByteIsCountedAsWritten) {
  const Session session = MakeSession("mapper-01", {10'000, 20'000}, 4);
  Client client = MakeClient("mapper-01");
  client.SendHeader(session);
  client.AwaitState(session.id.str(), ReceiptState::kNeedManifest);
  client.SendManifest(session);
  client.AwaitState(session.id.str(), ReceiptState::kReceiving);
  const std::string_view first = session.payloads[0];
  client.SendChunk(session, 0, 0, first.substr(0, 4'000));
  client.SendChunk(session, 0, 0, first.substr(0, 4'000));  // again
  client.SendChunk(session, 9, 0, "outside");
  const Receipt receipt = client.Await(session.id.str(), [](const Receipt& one) { return one.written_bytes >= 8'007; });
  EXPECT_EQ(receipt.written_bytes, 8'007u);
  EXPECT_GE(receipt.window_bytes, limits::kChunkBytesMax);
  ASSERT_TRUE(receipt.error);
  EXPECT_THAT(receipt.error->what, HasSubstr("payload 9"));
}

TEST_F(SessionTest, AWrongHashIsNamedAndCanBeMended) {
  const Session session = MakeSession("mapper-01", {10'000, 20'000}, 5);
  Client client = MakeClient("mapper-01");
  client.SendHeader(session);
  client.AwaitState(session.id.str(), ReceiptState::kNeedManifest);
  client.SendManifest(session);
  client.AwaitState(session.id.str(), ReceiptState::kReceiving);
  std::string spoiled = session.payloads[0];
  spoiled[17] = static_cast<char>(~spoiled[17]);
  client.SendChunk(session, 0, 0, spoiled);
  const Receipt complaint =
      client.Await(session.id.str(), [](const Receipt& receipt) { return receipt.error.has_value(); });
  EXPECT_EQ(complaint.state, ReceiptState::kReceiving);
  EXPECT_THAT(complaint.error->what, HasSubstr("front/100000.png"));
  EXPECT_FALSE(complaint.error->cure.empty());
  EXPECT_TRUE(Holds(complaint, 0));
  client.SendPayload(session, 1);
  client.SendPayload(session, 0);
  const Receipt closed = client.AwaitState(session.id.str(), ReceiptState::kClosed);
  EXPECT_FALSE(closed.error);
  ExpectStored(session);
}

TEST_F(SessionTest, AStrangerCannotSpeakForARobot) {
  const Session session = MakeSession("mapper-01", {1'000}, 6);
  Client stranger = MakeClient("stranger");
  stranger.SendHeader(session);
  const Receipt refused = stranger.AwaitState(session.id.str(), ReceiptState::kRefused);
  EXPECT_THAT(refused.error->what, HasSubstr("robot/stranger"));
  stranger.SendManifest(session);
  stranger.AwaitState(session.id.str(), ReceiptState::kRefused);
  storage::Store store = Must(storage::Store::Open(folder_.path()));
  EXPECT_FALSE(Must(storage::LoadSession(store, session.id)));
  MakeClient("mapper-01").Push(session);  // the real one is not disturbed
}

TEST_F(SessionTest, AManifestOfAnotherRobotIsRefused) {
  Session session = MakeSession("mapper-01", {1'000}, 7);
  session.robot = RobotId("mapper-02");
  Client client = MakeClient("mapper-02");
  client.SendHeader(session);
  client.AwaitState(session.id.str(), ReceiptState::kNeedManifest);
  client.SendManifest(session);
  const Receipt refused = client.AwaitState(session.id.str(), ReceiptState::kRefused);
  EXPECT_THAT(refused.error->what, HasSubstr("mapper-01"));
}

TEST_F(SessionTest, AStoredSessionStaysItsRobots) {
  Session session = MakeSession("mapper-01", {1'000}, 8);
  MakeClient("mapper-01").Push(session);
  session.robot = RobotId("mapper-02");
  Client client = MakeClient("mapper-02");
  client.SendHeader(session);
  EXPECT_THAT(client.AwaitState(session.id.str(), ReceiptState::kRefused).error->what, HasSubstr("mapper-01"));
}

TEST_F(SessionTest, AManifestThatIsNotTheSessionsIsRefused) {
  Session session = MakeSession("mapper-01", {1'000}, 9);
  const Session other = MakeSession("mapper-01", {1'000}, 10);
  Client client = MakeClient("mapper-01");
  session.manifest = other.manifest;
  client.SendManifest(session);
  EXPECT_THAT(client.AwaitState(session.id.str(), ReceiptState::kRefused).error->what, HasSubstr("hash"));
  session.manifest = "not json";
  session.id = SessionId(Sha256Of(std::string_view(session.manifest)).str());
  client.SendManifest(session);
  client.AwaitState(session.id.str(), ReceiptState::kRefused);
  client.Push(other);
}

TEST_F(SessionTest, ANewerProtocolIsRefusedWithASentence) {
  const Session session = MakeSession("mapper-01", {1'000}, 11);
  Client client = MakeClient("mapper-01");
  client.SendHeader(session, 2);
  const Receipt refused = client.AwaitState(session.id.str(), ReceiptState::kRefused);
  EXPECT_EQ(refused.error->code, ErrorCode::kUnsupported);
  EXPECT_THAT(refused.error->what, HasSubstr("protocol 2"));
}

TEST_F(SessionTest, WhatTheServerHoldsDoesNotTravelAgain) {
  const Session first = MakeSession("mapper-01", {1'000, 2'000}, 20);
  const Session second = MakeSession("mapper-01", {2'000, 3'000}, 21);  // its first payload is the other's second
  ASSERT_EQ(first.payloads[1], second.payloads[0]);
  Client client = MakeClient("mapper-01");
  client.Push(first);
  client.SendHeader(second);
  client.AwaitState(second.id.str(), ReceiptState::kNeedManifest);
  client.SendManifest(second);
  const Receipt receiving = client.AwaitState(second.id.str(), ReceiptState::kReceiving);
  EXPECT_TRUE(receiving.held[0]);
  EXPECT_FALSE(receiving.held[1]);
  client.SendPayload(second, 1);
  client.AwaitState(second.id.str(), ReceiptState::kClosed);
  ExpectStored(second);
}

// Who knows the digests of another robot's pictures, which anybody may read, has not got the pictures.
TEST_F(SessionTest, WhatAnotherRobotSentMustTravelAgain) {
  const Session first = MakeSession("mapper-01", {1'000, 2'000}, 20);
  MakeClient("mapper-01").Push(first);
  const Session foreign = OfRobot(first, "mapper-02", "foreign");
  Client other = MakeClient("mapper-02");
  other.SendHeader(foreign);
  other.AwaitState(foreign.id.str(), ReceiptState::kNeedManifest);
  other.SendManifest(foreign);
  const std::vector<bool> held = other.AwaitState(foreign.id.str(), ReceiptState::kReceiving).held;
  EXPECT_EQ(std::count(held.begin(), held.end(), true), 0);
  other.SendPayload(foreign, 0);
  other.SendPayload(foreign, 1);
  other.AwaitState(foreign.id.str(), ReceiptState::kClosed);
  ExpectStored(foreign);
}

TEST_F(SessionTest, TheNewestPushOfTheSamePicturesIsCurrent) {
  const Session right = MakeSession("mapper-01", {1'000, 2'000}, 20);
  const Session wrong = OfRobot(right, "mapper-01", "wrong");
  Client client = MakeClient("mapper-01");
  client.Push(right);
  client.SendHeader(wrong);
  client.AwaitState(wrong.id.str(), ReceiptState::kNeedManifest);
  client.SendManifest(wrong);
  client.AwaitState(wrong.id.str(), ReceiptState::kClosed);  // a corrected session.yaml needs no bytes
  EXPECT_EQ(CurrentOf(right.robot), wrong.id);
  EXPECT_EQ(Work().size(), 2u);

  client.SendPayload(right, 0);  // strays of the first push are no push
  const std::uint64_t told = client.AwaitState(right.id.str(), ReceiptState::kClosed).sequence_number;
  EXPECT_EQ(CurrentOf(right.robot), wrong.id);

  const auto push_again = [&](std::uint64_t after) {
    client.SendHeader(right);
    return client.Await(right.id.str(), [&](const Receipt& receipt) { return receipt.sequence_number > after; })
        .sequence_number;
  };
  const std::uint64_t again = push_again(told);
  EXPECT_EQ(CurrentOf(right.robot), right.id);
  EXPECT_EQ(Work().size(), 3u);
  push_again(again);  // current already: nothing to do
  EXPECT_EQ(Work().size(), 3u);
  StopServer();
  EXPECT_EQ(CurrentOf(right.robot), right.id);
}

TEST_F(SessionTest, OneContentInTwoPlacesTravelsOnce) {
  Session session = MakeSession("mapper-01", {5'000, 6'000, 7'000}, 30);
  Manifest manifest = Must(formats::ReadManifest(session.manifest));
  manifest.payloads[2].digest = manifest.payloads[0].digest;
  manifest.payloads[2].size_bytes = manifest.payloads[0].size_bytes;
  session.manifest = formats::WriteManifest(manifest);
  session.id = SessionId(Sha256Of(std::string_view(session.manifest)).str());
  Client client = MakeClient("mapper-01");
  client.SendManifest(session);
  client.AwaitState(session.id.str(), ReceiptState::kReceiving);
  client.SendPayload(session, 0);
  client.SendPayload(session, 1);
  EXPECT_TRUE(Holds(client.AwaitState(session.id.str(), ReceiptState::kClosed), 3));
}

TEST_F(SessionTest, OneContentInTwoPlacesMayTravelTwice) {
  Session session = MakeSession("mapper-01", {500'000, 600'000, 500'000}, 40);
  Manifest manifest = Must(formats::ReadManifest(session.manifest));
  manifest.payloads[2].digest = manifest.payloads[0].digest;
  session.payloads[2] = session.payloads[0];
  session.manifest = formats::WriteManifest(manifest);
  session.id = SessionId(Sha256Of(std::string_view(session.manifest)).str());
  Client client = MakeClient("mapper-01");
  client.SendManifest(session);
  client.AwaitState(session.id.str(), ReceiptState::kReceiving);
  for (const std::uint32_t i : {0, 2, 1, 0, 2}) client.SendPayload(session, i);
  EXPECT_TRUE(Holds(client.AwaitState(session.id.str(), ReceiptState::kClosed), 3));
  ExpectStored(session);
}

TEST_F(SessionTest, AFailingDiskIsToldAndHarmsNothing) {
  const Session session = MakeSession("mapper-01", {1'000, 2'000, 3'000}, 50);
  const auto blobs = folder_.path() / "blobs", away = folder_.path() / "away";
  Client client = MakeClient("mapper-01");
  client.SendManifest(session);
  client.AwaitState(session.id.str(), ReceiptState::kReceiving);
  client.SendPayload(session, 0);
  client.Await(session.id.str(), [](const Receipt& receipt) { return receipt.held[0]; });
  std::filesystem::rename(blobs, away);
  std::ofstream(blobs) << "in the way";
  client.SendPayload(session, 1);
  client.SendPayload(session, 2);
  const Receipt refused = client.AwaitState(session.id.str(), ReceiptState::kRefused);
  EXPECT_EQ(refused.error->code, ErrorCode::kStorage);
  std::filesystem::remove(blobs);
  std::filesystem::rename(away, blobs);
  client.SendHeader(session);
  const Receipt receiving = client.AwaitState(session.id.str(), ReceiptState::kReceiving);
  EXPECT_TRUE(receiving.held[0]);
  EXPECT_FALSE(receiving.held[1] || receiving.held[2]);
  client.SendPayload(session, 1);
  client.SendPayload(session, 2);
  client.AwaitState(session.id.str(), ReceiptState::kClosed);
  ExpectStored(session);
}

TEST_F(SessionTest, ManyRobotsAtOnce) {
  std::vector<Client> clients;
  std::vector<Session> sessions;
  for (unsigned i = 0; i < 4; ++i) {
    const std::string robot = "mapper-0" + std::to_string(i);
    clients.push_back(MakeClient(robot));
    sessions.push_back(MakeSession(robot, {100'000, 100'000}, 100 + 10 * i));
    clients.back().SendManifest(sessions.back());
  }
  for (unsigned i = 0; i < 4; ++i) {
    clients[i].AwaitState(sessions[i].id.str(), ReceiptState::kReceiving);
    clients[i].SendPayload(sessions[i], 0);
    clients[i].SendPayload(sessions[i], 1);
  }
  for (unsigned i = 0; i < 4; ++i) clients[i].AwaitState(sessions[i].id.str(), ReceiptState::kClosed);
  for (const Session& session : sessions) ExpectStored(session);
}

}  // namespace
}  // namespace rigcal::dds
