// What a site has still to send on: filled with what becomes whole, emptied by what the centre confirms.
#include <gmock/gmock.h>

#include "storage/access/access_tokens.h"
#include "storage/files/lost_blobs.h"
#include "storage/sessions/standing.h"
#include "storage/sites/content.h"
#include "storage/sites/forward_queue.h"
#include "storage/sites/superseded_there.h"
#include "tests/unit/storage/fixture.h"
#include "tests/unit/storage/old_store.h"

namespace rigcal::storage {
namespace {

const std::string kCentre = "https://centre";

class SitesTest : public StoreTest {
 protected:
  SessionId Open(std::size_t payloads) {
    const Manifest manifest = MakeManifest(payloads);
    const SessionId id = IdOf(manifest);
    EXPECT_TRUE(AppendSession(store_, id, "{\"manifest\": " + std::to_string(payloads) + "}", manifest, {5}));
    return id;
  }
  void Close(const SessionId& id, std::uint32_t payloads, Stamp at) {
    std::vector<std::uint32_t> all;
    for (std::uint32_t i = 0; i < payloads; ++i) all.push_back(i);
    ASSERT_TRUE(AppendHeld(store_, id, all, at));
    ASSERT_TRUE(CloseSession(store_, id, {}, at));
  }
  std::vector<std::string> Waiting() {
    std::vector<std::string> subjects;
    for (std::optional<WaitingForward> next; (next = LoadNextForward(store_, {10}).value());) {
      subjects.push_back(next->subject);
      EXPECT_TRUE(MarkForwarded(store_, *next, {10}));
    }
    return subjects;
  }
};

TEST_F(SitesTest, NothingWaitsWithoutACentre) {
  Close(Open(2), 2, {6});
  EXPECT_FALSE(LoadNextForward(store_, {10}).value());
  EXPECT_FALSE(LoadForwardState(store_).value());
}

TEST_F(SitesTest, WholeSessionsAndBatchesWaitInTheirOrder) {
  ASSERT_TRUE(SetCentre(store_, kCentre, {1}));
  const SessionId first = Open(2), second = Open(3);
  const BatchId batch(DigestOf("batch").str());
  const Edge edge = MakeEdge(1), other = MakeEdge(2);
  ASSERT_TRUE(store_.Write([&]() -> Status {
    RIGCAL_TRY(AppendBatch(store_, kRobot, batch, 2, {6}));
    return AppendBatchItems(store_, batch, {{0, edge}}, {6});
  }));
  EXPECT_FALSE(LoadNextForward(store_, {10}).value()) << "none is whole";
  Close(second, 3, {7});
  ASSERT_TRUE(AppendBatchItems(store_, batch, {{1, other}}, {8}));
  Close(first, 2, {9});
  const ForwardState state = LoadForwardState(store_).value().value();
  EXPECT_EQ(state.sessions_waiting, 2);
  EXPECT_EQ(state.batches_waiting, 1);
  EXPECT_EQ(state.oldest_at->ns, 6) << "that of the batch, before its last item";
  EXPECT_EQ(Waiting(), (std::vector{second.str(), batch.str(), first.str()}));
  EXPECT_TRUE(CloseSession(store_, first, {}, {11}));
  EXPECT_TRUE(Waiting().empty()) << "what was confirmed waits no more";
}

TEST_F(SitesTest, ANewCentreGetsWhatWasBefore) {
  const SessionId before = Open(2);
  Close(before, 2, {6});
  ASSERT_TRUE(SetCentre(store_, kCentre, {7}));
  EXPECT_EQ(Waiting(), std::vector{before.str()});
  ASSERT_TRUE(SetCentre(store_, kCentre, {8}));
  EXPECT_TRUE(Waiting().empty()) << "the same centre has it";
  ASSERT_TRUE(SetCentre(store_, "https://other", {9}));
  EXPECT_EQ(Waiting(), std::vector{before.str()});
  ASSERT_TRUE(SetCentre(store_, kCentre, {10}));
  EXPECT_TRUE(Waiting().empty()) << "it has it still";
  ASSERT_TRUE(SetCentre(store_, "", {11}));
  Close(Open(3), 3, {12});
  EXPECT_FALSE(LoadNextForward(store_, {13}).value());
}

TEST_F(SitesTest, WhatACentreLostIsOfferedToItAgain) {
  ASSERT_TRUE(SetCentre(store_, kCentre, {1}));
  EXPECT_TRUE(LoadNewestForwarded(store_)->empty()) << "it confirmed nothing";
  const SessionId first = Open(2), second = Open(3), waits = Open(4);
  Close(first, 2, {6});
  Close(second, 3, {7});
  for (const std::int64_t at : {9'000, 9})  // the clock was ahead
    ASSERT_TRUE(MarkForwarded(store_, LoadNextForward(store_, {10}).value().value(), {at}));
  Close(waits, 4, {10});
  const WaitingForward last = LoadNewestForwarded(store_)->at(0);
  EXPECT_EQ(last.subject, second.str());
  EXPECT_FALSE(last.is_batch);
  EXPECT_EQ(last.robot, kRobot);
  ASSERT_TRUE(ForwardAgain(store_));
  ASSERT_TRUE(ForwardAgain(store_)) << "twice is the same";
  EXPECT_EQ(Waiting(), (std::vector{waits.str(), first.str(), second.str()}));
  EXPECT_EQ(LoadNewestForwarded(store_)->at(0).subject, second.str()) << "it was confirmed anew, last of all";
}

TEST_F(SitesTest, SomeOfEachRobotAreAskedFor) {
  ASSERT_TRUE(SetCentre(store_, kCentre, {1}));
  const Manifest of_other = MakeManifest(2, kOtherRobot);
  ASSERT_TRUE(AppendSession(store_, IdOf(of_other), "{}", of_other, {5}));
  Close(IdOf(of_other), 2, {6});
  for (const std::uint32_t payloads : {2, 3, 4}) Close(Open(payloads), payloads, {7});
  EXPECT_EQ(Waiting().size(), 4u);
  std::vector<std::string> asked;
  const auto newest = LoadNewestForwarded(store_).value();
  for (const WaitingForward& one : newest) asked.push_back(one.robot.str() + " " + one.subject);
  EXPECT_EQ(asked, (std::vector{kRobot.str() + " " + IdOf(MakeManifest(4)).str(),
                                kRobot.str() + " " + IdOf(MakeManifest(3)).str(),
                                kOtherRobot.str() + " " + IdOf(of_other).str()}));
}

TEST(SitesMigration, WhatACentreConfirmedIsKept) {
  const TempFolder folder;
  MakeDatabase(folder.path(), EmptyStoreBefore("0054_site_order.sql") +
                                  "INSERT INTO robot VALUES ('r', 1);"
                                  "INSERT INTO centre VALUES (1, 'https://centre', 1);"
                                  "INSERT INTO batch VALUES (1, 'b1', 'r', 0, 1), (2, 'b2', 'r', 0, 1);"
                                  "INSERT INTO forwarded VALUES ('https://centre', 'batch', 'b2', 5), "
                                  "('https://centre', 'batch', 'b1', 9);");
  Result<Store> store = Store::Open(folder.path());
  ASSERT_TRUE(store) << WordsOf(store);
  const auto newest = LoadNewestForwarded(*store).value();
  ASSERT_EQ(newest.size(), 2u);
  EXPECT_EQ(newest[0].subject, "b1");
  EXPECT_EQ(newest[1].subject, "b2");
  EXPECT_EQ(newest[0].robot, RobotId("r"));
}

TEST_F(SitesTest, WhatIsRefusedHoldsUpNothing) {
  ASSERT_TRUE(SetCentre(store_, kCentre, {1}));
  const SessionId first = Open(2), second = Open(3);
  Close(first, 2, {6});
  Close(second, 3, {7});
  const WaitingForward refused = LoadNextForward(store_, {10}).value().value();
  ASSERT_TRUE(NoteForwardFailure(store_, refused, "no such robot", {1'000}, {10}));
  EXPECT_EQ(LoadNextForward(store_, {10})->value().subject, second.str());
  ForwardState state = LoadForwardState(store_).value().value();
  EXPECT_EQ(state.refused, 1);
  EXPECT_EQ(state.last_error, "no such robot");
  EXPECT_FALSE(state.failing_since);
  EXPECT_EQ(LoadNextForward(store_, {1'000})->value().subject, first.str());

  const WaitingForward away = LoadNextForward(store_, {10}).value().value();
  for (const std::int64_t at : {20, 30}) ASSERT_TRUE(NoteForwardFailure(store_, away, "no answer", {}, {at}));
  EXPECT_EQ(LoadNextForward(store_, {10})->value().subject, second.str()) << "it keeps its turn";
  state = LoadForwardState(store_).value().value();
  EXPECT_EQ(state.failing_since->ns, 20) << "since the first of the failures";
  EXPECT_EQ(state.last_error, "no answer");
  EXPECT_EQ(LoadNextForward(store_, {10})->value().attempts, 2);
  ASSERT_TRUE(SetCentre(store_, kCentre, {40}));
  EXPECT_EQ(LoadNextForward(store_, {10})->value().subject, first.str()) << "a new start tries again";
}

TEST_F(SitesTest, TellsWhatSupersedesASession) {
  const SessionId first = Open(2), second = Open(3);
  Close(first, 2, {6});
  EXPECT_TRUE(LoadSuperseding(store_, first)->empty());
  Close(second, 3, {7});
  EXPECT_EQ(LoadSuperseding(store_, first).value(), std::vector{second});
  EXPECT_TRUE(LoadSuperseding(store_, second)->empty());
  ASSERT_TRUE(MakeCurrent(store_, first, MadeCurrent::kPushedAgain, {{8}, "robot mapper-01", ""}));
  EXPECT_TRUE(LoadSuperseding(store_, first)->empty());
  EXPECT_EQ(LoadSuperseding(store_, second).value(), std::vector{first});
}

// The late one holds less than half of the other: by itself it would be a measurement of its own.
TEST_F(SitesTest, ACorrectionThatCameFirstStaysCurrent) {
  const SessionId corrected = Open(9);
  Close(corrected, 9, {6});
  const SessionId late = Open(2);
  ASSERT_TRUE(NoteSuperseding(store_, late, {corrected}));
  Close(late, 2, {7});
  const auto superseded = LoadSuperseded(store_, kRobot).value();
  ASSERT_EQ(superseded.size(), 1u);
  ASSERT_TRUE(superseded.contains(late));
  EXPECT_EQ(superseded.at(late).by, corrected);
  EXPECT_FALSE(TakeSupersedingNoted(store_, late).value()) << "it is whole";
}

TEST_F(SitesTest, ALateSessionLeavesWhatAPersonMadeCurrent) {
  const SessionId corrected = Open(3), other = Open(4), late = Open(2);
  Close(corrected, 3, {6});
  Close(other, 4, {7});
  ASSERT_TRUE(MakeCurrent(store_, corrected, MadeCurrent::kRestored, {{8}, "Ada", "that was right"}));
  ASSERT_TRUE(NoteSuperseding(store_, late, {other}));
  Close(late, 2, {9});
  const auto superseded = LoadSuperseded(store_, kRobot).value();
  EXPECT_EQ(superseded.size(), 2u);
  EXPECT_FALSE(superseded.contains(corrected));
}

TEST_F(SitesTest, WhatASiteSaysLastOfASessionHolds) {
  const SessionId other = Open(3), late = Open(2);
  Close(other, 3, {6});
  ASSERT_TRUE(NoteSuperseding(store_, late, {other, SessionId(DigestOf("unknown").str())}));
  ASSERT_TRUE(NoteSuperseding(store_, late, {}));
  Close(late, 2, {7});
  EXPECT_TRUE(LoadSuperseded(store_, kRobot)->contains(other)) << "it was made current at the site meanwhile";
}

TEST_F(SitesTest, WhatWasLostAndPushedAgainIsSentAtOnce) {
  ASSERT_TRUE(SetCentre(store_, kCentre, {1}));
  const SessionId session = Open(2);
  Close(session, 2, {6});
  ASSERT_TRUE(NoteForwardFailure(store_, LoadNextForward(store_, {10}).value().value(), "lost", {1'000}, {10}));
  ASSERT_TRUE(AppendLost(store_, MakeManifest(2).payloads[1].digest, BlobState::kMissing, std::nullopt, {11}));
  EXPECT_FALSE(LoadNextForward(store_, {12}).value());
  ASSERT_TRUE(AppendHeld(store_, session, {1}, {13}));
  EXPECT_EQ(LoadNextForward(store_, {14}).value().value().subject, session.str());
}

TEST_F(SitesTest, FindsFilesByTheirContent) {
  const SessionId id = Open(2);
  const Manifest manifest = MakeManifest(2);
  ASSERT_TRUE(AppendHeld(store_, id, {1}, {6}));
  const NamedPayload second = LoadNamedPayload(store_, id, manifest.payloads[1].digest).value().value();
  EXPECT_EQ(second.robot, kRobot);
  EXPECT_EQ(second.idx, 1u);
  EXPECT_EQ(second.size_bytes, 1001);
  EXPECT_TRUE(second.is_held);
  EXPECT_FALSE(LoadNamedPayload(store_, id, manifest.payloads[0].digest)->value().is_held);
  EXPECT_FALSE(LoadNamedPayload(store_, id, DigestOf("another")).value());
  EXPECT_FALSE(LoadNamedPayload(store_, SessionId(DigestOf("none").str()), manifest.payloads[0].digest).value());
  EXPECT_EQ(LoadManifestText(store_, id).value(), "{\"manifest\": 2}");
}

TEST_F(SitesTest, GivesABatchInParts) {
  const BatchId batch(DigestOf("batch").str());
  const std::vector<Edge> edges = {MakeEdge(1), MakeEdge(2), MakeEdge(3)};
  ASSERT_TRUE(store_.Write([&]() -> Status {
    RIGCAL_TRY(AppendBatch(store_, kRobot, batch, 3, {6}));
    return AppendBatchItems(store_, batch, {{0, edges[0]}, {1, edges[1]}, {2, edges[2]}}, {6});
  }));
  const BatchPart part = LoadBatchPart(store_, batch, 1, 1).value();
  EXPECT_EQ(part.robot, kRobot);
  EXPECT_EQ(part.count, 3);
  EXPECT_EQ(part.items, (std::vector<std::pair<std::int64_t, EdgeId>>{{1, edges[1].id}}));
  EXPECT_TRUE(LoadBatchPart(store_, batch, 3, 128)->items.empty());
}

TEST_F(SitesTest, ATokenOfASiteIsOfItsRobotsAlone) {
  const Word word{{9}, "root", ""};
  ASSERT_TRUE(AddAccessToken(store_, {0, "harbour", Role::kViewer, DigestOf("a"), word, "harbour-*,bench"}));
  ASSERT_TRUE(AddAccessToken(store_, {0, "grafana", Role::kViewer, DigestOf("b"), word}));
  const AccessToken site = LoadAccessToken(store_, DigestOf("a")).value().value();
  EXPECT_TRUE(site.is_site());
  EXPECT_EQ(site.robots, "harbour-*,bench");
  EXPECT_FALSE(LoadAccessToken(store_, DigestOf("b"))->value().is_site());
  EXPECT_FALSE(AddAccessToken(store_, {0, "other", Role::kViewer, DigestOf("c"), word, "a b"}));
}

}  // namespace
}  // namespace rigcal::storage
