#include <gmock/gmock.h>

#include "server/formats/documents.h"
#include "tests/unit/storage/fixture.h"

namespace rigcal::storage {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

class SessionsTest : public StoreTest {};

TEST_F(SessionsTest, AnUnknownSessionIsNoError) {
  const SessionId unknown(DigestOf("unknown").str());
  EXPECT_EQ(LoadSession(store_, unknown).value(), std::nullopt);
  EXPECT_FALSE(LoadManifest(store_, unknown).value().has_value());
  EXPECT_EQ(LoadHeld(store_, unknown).error().code, ErrorCode::kNotFound);
  EXPECT_EQ(AppendHeld(store_, unknown, {0}, {1}).error().code, ErrorCode::kNotFound);
  EXPECT_EQ(CloseSession(store_, unknown, {}, {1}).error().code, ErrorCode::kNotFound);
}

TEST_F(SessionsTest, EveryFieldComesBack) {
  const Manifest manifest = MakeManifest(3);
  const SessionId id = AppendOpenSession(store_, 3);
  ASSERT_TRUE(AppendHeld(store_, id, {2}, {20}));
  const SessionRow row = LoadSession(store_, id).value().value();
  EXPECT_EQ(row.robot, kRobot);
  EXPECT_EQ(row.id, id);
  EXPECT_FALSE(row.closed);
  EXPECT_EQ(row.payloads, 3);
  EXPECT_EQ(row.payloads_held, 1);
  EXPECT_EQ(row.bytes, 1000 + 1001 + 1002);
  EXPECT_EQ(row.captured_at, manifest.header.captured_at);
  EXPECT_EQ(row.opened_at.ns, 10);
  EXPECT_EQ(row.closed_at.ns, 0);
  EXPECT_EQ(row.operator_name, "Ada");
}

TEST_F(SessionsTest, TheManifestComesBack) {
  const Manifest manifest = MakeManifest(4);
  const std::string text = formats::WriteManifest(manifest);
  const SessionId id(Sha256Of(text).str());
  ASSERT_TRUE(AppendSession(store_, id, text, manifest, {1}));
  const Result<std::optional<Manifest>> loaded = LoadManifest(store_, id);
  ASSERT_TRUE(loaded) << WordsOf(loaded);
  EXPECT_EQ(formats::WriteManifest(**loaded), text);
}

TEST_F(SessionsTest, AppendingAgainChangesNothing) {
  const SessionId id = AppendOpenSession(store_, 3);
  ASSERT_TRUE(AppendSession(store_, id, "other", MakeManifest(3), {999}));
  EXPECT_EQ(LoadSession(store_, id).value()->opened_at.ns, 10);
  EXPECT_EQ(LoadSession(store_, id).value()->payloads, 3);
}

TEST_F(SessionsTest, ASessionWithoutPayloadsIsHeldWhole) {
  const SessionId id = AppendOpenSession(store_, 0);
  EXPECT_TRUE(LoadHeld(store_, id).value().empty());
  EXPECT_TRUE(CloseSession(store_, id, {}, {1}));
}

TEST_F(SessionsTest, HeldIsByPosition) {
  const SessionId id = AppendOpenSession(store_, 5);
  EXPECT_THAT(LoadHeld(store_, id).value(), ElementsAre(false, false, false, false, false));
  ASSERT_TRUE(AppendHeld(store_, id, {1, 4, 1}, {1}));
  ASSERT_TRUE(AppendHeld(store_, id, {4}, {2}));
  EXPECT_THAT(LoadHeld(store_, id).value(), ElementsAre(false, true, false, false, true));
  EXPECT_EQ(LoadSession(store_, id).value()->payloads_held, 2);
}

TEST_F(SessionsTest, APositionBeyondTheManifestIsRefusedWhole) {
  const SessionId id = AppendOpenSession(store_, 2);
  const Status held = AppendHeld(store_, id, {0, 2}, {1});
  ASSERT_FALSE(held);
  EXPECT_EQ(held.error().code, ErrorCode::kInvalidInput);
  EXPECT_THAT(held.error().what, HasSubstr("no payload 2"));
  EXPECT_THAT(LoadHeld(store_, id).value(), ElementsAre(false, false));
}

TEST_F(SessionsTest, ADigestIsHeldForTheRobotThatSentIt) {
  const Manifest manifest = MakeManifest(2);
  const SessionId first = AppendOpenSession(store_, 2);
  EXPECT_FALSE(IsHeld(store_, kRobot, manifest.payloads[1].digest).value());
  ASSERT_TRUE(AppendHeld(store_, first, {1}, {1}));
  EXPECT_TRUE(IsHeld(store_, kRobot, manifest.payloads[1].digest).value());
  EXPECT_FALSE(IsHeld(store_, kRobot, manifest.payloads[0].digest).value());
  EXPECT_FALSE(IsHeld(store_, RobotId("mapper-02"), manifest.payloads[1].digest).value());
  // The same picture in another session: its own receipt is still to be given.
  const SessionId second = AppendOpenSession(store_, 3);
  EXPECT_THAT(LoadHeld(store_, second).value(), ElementsAre(false, false, false));
}

TEST_F(SessionsTest, FilesOfAnotherRobotAreToldOnceItsSessionIsWhole) {
  const RobotId other("other");
  const Manifest manifest = MakeManifest(4);
  std::set<Digest> digests;
  for (const Payload& payload : manifest.payloads) digests.insert(payload.digest);
  const SessionId open = AppendOpenSession(store_, 4);
  EXPECT_FALSE(LoadHeldByAnother(store_, other, digests)->has_value()) << "it may never come whole";
  ASSERT_TRUE(AppendHeld(store_, open, {0, 1, 2, 3}, {11}));
  ASSERT_TRUE(CloseSession(store_, open, {}, {12}));
  const auto held = LoadHeldByAnother(store_, other, digests).value();
  ASSERT_TRUE(held);
  EXPECT_EQ(held->robot, kRobot);
  EXPECT_EQ(held->session, open);
  EXPECT_EQ(held->contents, digests.size());
  EXPECT_FALSE(LoadHeldByAnother(store_, kRobot, digests)->has_value()) << "its own";
  EXPECT_FALSE(LoadHeldByAnother(store_, other, {Digest(std::string(64, 'e'))})->has_value());
}

TEST_F(SessionsTest, OnlyAWholeSessionCloses) {
  const SessionId id = AppendOpenSession(store_, 2);
  ASSERT_TRUE(AppendHeld(store_, id, {0}, {1}));
  const Status closed = CloseSession(store_, id, {{kLeft, kRight}}, {5});
  ASSERT_FALSE(closed);
  EXPECT_EQ(closed.error().code, ErrorCode::kConflict);
  EXPECT_THAT(closed.error().what, HasSubstr("holds 1 of 2 payloads"));
  EXPECT_FALSE(LoadSession(store_, id).value()->closed);
  EXPECT_EQ(CountJobs(store_, id).value().total, 0);
}

TEST_F(SessionsTest, ClosingTwiceQueuesOnce) {
  const std::vector<SensorPair> pairs = {{kLeft, kRight}, {kLeft, kThird}, {kLeft, kRight}};
  const SessionId id = AppendClosedSession(store_, 2, pairs);
  ASSERT_TRUE(CloseSession(store_, id, pairs, {99}));
  const SessionRow row = LoadSession(store_, id).value().value();
  EXPECT_TRUE(row.closed);
  EXPECT_EQ(row.closed_at.ns, 12);
  EXPECT_EQ(row.payloads_held, 2);
  EXPECT_EQ(CountJobs(store_, id).value().total, 2);
}

TEST_F(SessionsTest, ListsAreNewestVisitFirst) {
  const auto append = [&](const char* name, std::int64_t captured_ns, const RobotId& robot) {
    Manifest manifest = MakeManifest(1, robot);
    manifest.header.captured_at = {captured_ns};
    const SessionId id(DigestOf(name).str());
    EXPECT_TRUE(AppendSession(store_, id, "{}", manifest, {1}));
    return id;
  };
  const SessionId middle = append("middle", 20, kRobot);
  const SessionId other = append("other", 25, RobotId("mapper-02"));
  const SessionId newest = append("newest", 30, kRobot);
  const SessionId oldest = append("oldest", 10, kRobot);
  const auto ids = [&](const RobotId& robot) {
    std::vector<SessionId> listed;
    const std::vector<SessionRow> rows = LoadSessions(store_, robot).value();
    for (const SessionRow& row : rows) listed.push_back(row.id);
    return listed;
  };
  EXPECT_THAT(ids(kRobot), ElementsAre(newest, middle, oldest));
  EXPECT_THAT(ids(RobotId()), ElementsAre(newest, other, middle, oldest));
  EXPECT_TRUE(ids(RobotId("nobody")).empty());
}

TEST_F(SessionsTest, RobotsAreCounted) {
  ASSERT_TRUE(AppendRobot(store_, RobotId("quiet"), {5}));
  ASSERT_TRUE(AppendRobot(store_, RobotId("quiet"), {6}));
  AppendOpenSession(store_, 1);
  AppendOpenSession(store_, 2);
  ASSERT_TRUE(AppendEdge(store_, MakeEdge(1), {1}));
  const auto robot = LoadRobot(store_, kRobot).value(), quiet = LoadRobot(store_, RobotId("quiet")).value();
  ASSERT_TRUE(robot && quiet);
  EXPECT_EQ(robot->robot, kRobot);
  EXPECT_EQ(robot->sessions, 2);
  EXPECT_EQ(robot->edges, 1);
  EXPECT_EQ(quiet->robot, RobotId("quiet"));
  EXPECT_EQ(quiet->first_seen_at.ns, 5);
  EXPECT_EQ(quiet->sessions + quiet->edges, 0);
  EXPECT_FALSE(LoadRobot(store_, RobotId("nobody")).value());
}

TEST_F(SessionsTest, TheNewestCaptureIsThatOfASessionThatCameWhole) {
  EXPECT_FALSE(LoadNewestCapture(store_, kRobot).value());
  const auto append = [&](std::size_t payloads, std::int64_t captured_ns, bool whole) {
    Manifest manifest = MakeManifest(payloads);
    manifest.header.captured_at = {captured_ns};
    manifest.header.operator_name = "who was there at " + std::to_string(captured_ns);
    const SessionId id = IdOf(manifest);
    ASSERT_TRUE(AppendSession(store_, id, "{}", manifest, {10}));
    std::vector<std::uint32_t> all(payloads);
    for (std::uint32_t i = 0; i < payloads; ++i) all[i] = i;
    ASSERT_TRUE(AppendHeld(store_, id, all, {11}));
    if (!whole) return;
    ASSERT_TRUE(CloseSession(store_, id, {}, {12}));
  };
  append(1, 50, true);
  append(2, 40, true);
  append(3, 60, false);
  EXPECT_EQ(LoadNewestCapture(store_, kRobot).value()->at, Stamp{50});
  EXPECT_EQ(LoadNewestCapture(store_, kRobot).value()->operator_name, "who was there at 50");
  EXPECT_FALSE(LoadNewestCapture(store_, RobotId("nobody")).value());
}

TEST_F(SessionsTest, ARobotWithoutANameIsRefused) {
  EXPECT_EQ(AppendRobot(store_, RobotId("../x"), {1}).error().code, ErrorCode::kInvalidInput);
}

}  // namespace
}  // namespace rigcal::storage
