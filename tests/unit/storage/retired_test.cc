// What was taken out by a word, and brought back: edges, sessions, sensors.
#include "storage/sessions/retired.h"

#include <gmock/gmock.h>

#include "server/formats/documents.h"
#include "storage/revisions/decisions.h"
#include "storage/revisions/merged_edges.h"
#include "storage/sessions/standing.h"
#include "tests/unit/storage/fixture.h"
#include "tests/unit/storage/old_store.h"

namespace rigcal::storage {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Pair;

template <typename Map>
std::vector<typename Map::key_type> KeysOf(const Result<Map>& map) {
  std::vector<typename Map::key_type> keys;
  for (const auto& [key, value] : map.value()) keys.push_back(key);
  return keys;
}

class RetiredTest : public StoreTest {
 protected:
  // A closed session of the pictures below `to`; `note` makes it another session.
  SessionId Push(int to, const std::string& note, Stamp at) {
    Manifest manifest = MakeManifest(static_cast<std::size_t>(to));
    manifest.header.operator_name = note;
    manifest.header.captured_at = at;
    if (!reference_.empty()) manifest.header.reference = reference_;
    const std::string text = formats::WriteManifest(manifest);
    const SessionId id(Sha256Of(text).str());
    std::vector<std::uint32_t> all(manifest.payloads.size());
    for (std::uint32_t i = 0; i < all.size(); ++i) all[i] = i;
    EXPECT_TRUE(AppendSession(store_, id, text, manifest, at));
    EXPECT_TRUE(AppendHeld(store_, id, all, at));
    EXPECT_TRUE(CloseSession(store_, id, {}, at));
    return id;
  }
  std::int64_t Watermark() { return LoadStandingWatermark(store_, kRobot).value(); }
  std::vector<std::string> Audit() { return ColumnIn(store_, "SELECT who || ' ' || what FROM audit ORDER BY number"); }

  SensorId reference_;
  const SensorId left_{"left"}, right_{"right"};
};

TEST_F(RetiredTest, ASensorIsRetiredAndRestoredAndTheFirstWordHolds) {
  Push(1, "first", {1});
  ASSERT_TRUE(RetireSensor(store_, kRobot, right_, {{5}, "Ada", "taken off"}));
  const std::int64_t said = Watermark();
  ASSERT_TRUE(RetireSensor(store_, kRobot, right_, {{6}, "Bob", "me too"}));
  EXPECT_EQ(Watermark(), said);
  const auto retired = LoadRetiredSensors(store_, kRobot).value();
  ASSERT_EQ(retired.size(), 1u);
  EXPECT_EQ(retired.at(right_).word, (Word{{5}, "Ada", "taken off"}));
  EXPECT_THAT(LoadRetiredSensors(store_, RobotId("mapper-02")).value(), IsEmpty());

  ASSERT_TRUE(RestoreSensor(store_, kRobot, right_, {{7}, "Ada", "back"}));
  EXPECT_THAT(LoadRetiredSensors(store_, kRobot).value(), IsEmpty());
  const std::int64_t restored = Watermark();
  EXPECT_GT(restored, said);
  ASSERT_TRUE(RestoreSensor(store_, kRobot, right_, {{8}, "Bob", "again"}));
  EXPECT_EQ(Watermark(), restored);
  EXPECT_EQ(LoadStanding(store_, kRobot, right_).value()->how, "restored");
  ASSERT_TRUE(RetireSensor(store_, kRobot, right_, {{9}, "Eve", "broken"}));
  Store reopened = Open();
  EXPECT_EQ(LoadRetiredSensors(reopened, kRobot)->at(right_).word.who, "Eve");
  EXPECT_THAT(Audit(), ElementsAre("Ada retired sensor right of robot mapper-01: taken off",
                                   "Ada restored sensor right of robot mapper-01: back",
                                   "Eve retired sensor right of robot mapper-01: broken"));
}

TEST_F(RetiredTest, OnlyAKnownSensorOfTheRobotIsRetired) {
  const Word word{{5}, "Ada", "taken off"};
  EXPECT_EQ(RetireSensor(store_, kRobot, right_, word).error().code, ErrorCode::kNotFound);
  EXPECT_FALSE(LoadStanding(store_, kRobot, right_).value().has_value());
  ASSERT_TRUE(AppendEdge(store_, MakeEdge(1), {1}));  // left - s1
  EXPECT_TRUE(RetireSensor(store_, kRobot, SensorId("s1"), word));
  EXPECT_EQ(RetireSensor(store_, RobotId("mapper-02"), SensorId("s1"), word).error().code, ErrorCode::kNotFound);
  Push(1, "lists right", {1});
  EXPECT_TRUE(RetireSensor(store_, kRobot, right_, word));
  EXPECT_EQ(RetireSensor(store_, kRobot, left_, {{5}, "Ada", "two\nlines"}).error().code, ErrorCode::kInvalidInput);
  EXPECT_THAT(KeysOf(LoadRetiredSensors(store_, kRobot)), ElementsAre(right_, SensorId("s1")));
}

TEST_F(RetiredTest, AnEdgeIsRestored) {
  const EdgeId id = MakeEdge(1).id;
  ASSERT_TRUE(AppendEdge(store_, MakeEdge(1), {1}));
  EXPECT_FALSE(LoadStanding(store_, id).value().has_value());
  ASSERT_TRUE(RestoreEdge(store_, id, {{4}, "Ada", ""}));  // it was not retired
  EXPECT_FALSE(LoadStanding(store_, id).value().has_value());
  ASSERT_TRUE(RetireEdge(store_, id, {{5}, "Ada", "typed wrong"}));
  EXPECT_THAT(KeysOf(LoadRetired(store_, kRobot)), ElementsAre(id));
  ASSERT_TRUE(RestoreEdge(store_, id, {{6}, "Ada", "it was right"}));
  EXPECT_THAT(LoadRetired(store_, kRobot).value(), IsEmpty());
  ASSERT_TRUE(RetireEdge(store_, id, {{7}, "Bob", "it was not"}));
  EXPECT_EQ(LoadRetired(store_, kRobot)->at(id).word.who, "Bob");
}

TEST_F(RetiredTest, ASessionStaysRetiredWhenItIsPushedAgainAndIsRestored) {
  const SessionId session = Push(2, "blurred", {1});
  ASSERT_TRUE(RetireSession(store_, session, {{5}, "Ada", "blurred"}));
  ASSERT_TRUE(RetireSession(store_, session, {{6}, "Bob", "me too"}));
  EXPECT_EQ(LoadRetiredSessions(store_, kRobot)->at(session).word.who, "Ada");
  EXPECT_EQ(LoadStanding(store_, session).value()->how, "retired");
  EXPECT_FALSE(MakeCurrent(store_, session, MadeCurrent::kPushedAgain, {{7}, "robot mapper-01", ""}).value());
  EXPECT_THAT(KeysOf(LoadRetiredSessions(store_, kRobot)), ElementsAre(session));
  EXPECT_TRUE(MakeCurrent(store_, session, MadeCurrent::kRestored, {{8}, "Ada", ""}).value());
  EXPECT_THAT(LoadRetiredSessions(store_, kRobot).value(), IsEmpty());
  EXPECT_FALSE(MakeCurrent(store_, session, MadeCurrent::kRestored, {{9}, "Ada", ""}).value());
  EXPECT_THAT(Audit(),
              ElementsAre(HasSubstr("Ada retired session " + session.str()), HasSubstr("Ada restored session")));
  const SessionId open = AppendOpenSession(store_, 3);
  EXPECT_EQ(RetireSession(store_, open, {{5}, "Ada", "x"}).error().code, ErrorCode::kConflict);
  EXPECT_EQ(RetireSession(store_, SessionId(std::string(64, '0')), {{5}, "Ada", "x"}).error().code,
            ErrorCode::kNotFound);
}

TEST_F(RetiredTest, WhatARetiredSessionSupersededStaysSoUntilItIsRestored) {
  const SessionId wrong = Push(4, "wrong squares", {1}), right = Push(4, "right squares", {2});
  const auto superseded = [&] {
    std::map<SessionId, SessionId> by;
    const auto loaded = LoadSuperseded(store_, kRobot);
    for (const auto& [old, superseding] : *loaded) by[old] = superseding.by;
    return by;
  };
  ASSERT_TRUE(RetireSession(store_, right, {{5}, "Ada", "blurred"}));
  EXPECT_THAT(superseded(), ElementsAre(Pair(wrong, right)));
  ASSERT_TRUE(MakeCurrent(store_, wrong, MadeCurrent::kRestored, {{6}, "Ada", ""}).value());
  EXPECT_THAT(superseded(), ElementsAre(Pair(right, wrong)));
  EXPECT_THAT(KeysOf(LoadRetiredSessions(store_, kRobot)), ElementsAre(right));
  ASSERT_TRUE(RetireSession(store_, wrong, {{7}, "Ada", "wrong squares"}));  // makes nothing else current
  EXPECT_THAT(superseded(), ElementsAre(Pair(right, wrong)));
}

TEST_F(RetiredTest, TheReferenceIsThatOfTheEarliestSessionThatNamesNoneThatIsGone) {
  EXPECT_TRUE(LoadNamedReference(store_, kRobot, {})->empty());
  reference_ = right_;
  Push(1, "later", {20});
  reference_ = left_;
  Push(2, "earlier", {10});
  EXPECT_EQ(*LoadNamedReference(store_, kRobot, {}), left_);
  EXPECT_EQ(*LoadNamedReference(store_, kRobot, {left_}), right_);
  EXPECT_TRUE(LoadNamedReference(store_, kRobot, {left_, right_})->empty());
  EXPECT_TRUE(LoadNamedReference(store_, RobotId("mapper-02"), {})->empty());
  AppendOpenSession(store_, 3);  // is not closed
  EXPECT_EQ(*LoadNamedReference(store_, kRobot, {}), left_);
}

TEST_F(RetiredTest, ARobotWithEdgesIsUnsolvedUntilARevisionCountsTheWord) {
  ASSERT_TRUE(AppendEdge(store_, MakeEdge(1), {1}));
  const auto revise = [&] {
    Revision revision = MakeRevision(LoadEdgeWatermark(store_, kRobot).value());
    revision.standing_watermark = Watermark();
    EXPECT_TRUE(AppendRevision(store_, revision));
  };
  revise();
  EXPECT_FALSE(*IsUnsolved(store_, kRobot));
  ASSERT_TRUE(RetireSensor(store_, kRobot, SensorId("s1"), {{5}, "Ada", "taken off"}));
  Store reopened = Open();  // after a crash between the word and the revision as well
  EXPECT_TRUE(*IsUnsolved(reopened, kRobot));
  revise();
  EXPECT_FALSE(*IsUnsolved(store_, kRobot));
}

// A sensor that is gone was measured rightly: the poses of the others are.
TEST_F(RetiredTest, WhatCountedSomethingWrongIsUsedNoMoreUntilThatIsRestored) {
  Edge edge = MakeEdge(1);
  edge.session = Push(1, "blurred", {1});
  ASSERT_TRUE(AppendEdge(store_, edge, {1}));
  Revision revision = MakeRevision(LoadEdgeWatermark(store_, kRobot).value());
  revision.standing_watermark = Watermark();
  ASSERT_TRUE(AppendRevision(store_, revision));
  ASSERT_TRUE(AppendDecision(store_, kRobot, 1, Deciding::kApprove, {{4}, "Ada", "checked"}));
  const auto usable = [&] { return LoadUsableRevision(store_, kRobot).value().has_value(); };
  EXPECT_TRUE(usable());
  ASSERT_TRUE(RetireSession(store_, edge.session, {{5}, "Ada", "blurred"}));
  EXPECT_FALSE(usable());
  ASSERT_TRUE(MakeCurrent(store_, edge.session, MadeCurrent::kRestored, {{6}, "Ada", ""}).value());
  EXPECT_TRUE(usable());
  ASSERT_TRUE(RetireEdge(store_, edge.id, {{7}, "Ada", "typed wrong"}));
  EXPECT_FALSE(usable());
  ASSERT_TRUE(RestoreEdge(store_, edge.id, {{8}, "Ada", ""}));
  EXPECT_TRUE(usable());
  ASSERT_TRUE(RetireSensor(store_, kRobot, SensorId("s1"), {{9}, "Ada", "taken off"}));
  EXPECT_TRUE(usable());
}

TEST_F(RetiredTest, WhatWasMergedIsOutdatedByASensorOfIt) {
  for (int i = 0; i < 3; ++i) ASSERT_TRUE(AppendEdge(store_, MakeEdge(i), {1}));  // left - s0, left - s1, left - s2
  const auto outdated = [&] { return *IsMergeOutdated(store_, kRobot, *LoadWhatCounts(store_, kRobot)); };
  const auto merge = [&](const MergeStep& step) {
    ASSERT_TRUE(store_.Write([&]() -> Status {
      RIGCAL_ASSIGN(const int number, AppendRevision(store_, MakeRevision(1)));
      return AppendMergedEdges(store_, {kRobot, number}, step, *LoadWhatCounts(store_, kRobot));
    }));
  };
  merge({{}, {MakeEdge(0).id}, {}});
  ASSERT_TRUE(RetireSensor(store_, kRobot, SensorId("s1"), {{5}, "Ada", "taken off"}));
  EXPECT_FALSE(outdated());  // its edges stand as they are
  ASSERT_TRUE(RetireSensor(store_, kRobot, SensorId("s0"), {{6}, "Ada", "taken off"}));
  EXPECT_TRUE(outdated());
  merge({{}, {MakeEdge(0).id}, {MakeEdge(0).id, MakeEdge(1).id, MakeEdge(2).id}});
  EXPECT_FALSE(outdated());
  ASSERT_TRUE(RestoreSensor(store_, kRobot, SensorId("s0"), {{7}, "Ada", "back"}));
  EXPECT_TRUE(outdated());
}

// A store of the version before: its words stand as they were, and what a migrated session names is known.
TEST(RetiredMigration, AnOlderStoreKeepsItsWords) {
  const TempFolder folder;
  std::string sql = EmptyStoreOfVersion(7);
  sql +=
      "INSERT INTO robot VALUES ('mapper-01', 1);"
      "INSERT INTO session VALUES (1, printf('%064d', 1), 'mapper-01', 1, 2, 'Ada', 0, 0, '{\"reference\":\"left\"}');"
      "INSERT INTO session_closed VALUES (1, 4);"
      "INSERT INTO standing VALUES (1, 'mapper-01', 4, 'pushed', 1, NULL, 'robot mapper-01', '');"
      "INSERT INTO edge (number, edge_id, robot_id, epoch, frame_a, frame_b, method, state, appended_ns) VALUES "
      "(1, printf('%064d', 8), 'mapper-01', 1, 'left', 'right', 'stereo', 'failed', 5);"
      "INSERT INTO counted_edge VALUES (1, 1, 'mapper-01');"
      "INSERT INTO standing VALUES (2, 'mapper-01', 5, 'retired', NULL, 1, 'Ada', 'typed wrong');";
  MakeDatabase(folder.path(), sql);
  Result<Store> store = Store::Open(folder.path());
  ASSERT_TRUE(store) << WordsOf(store);
  const EdgeId edge(std::string(63, '0') + "8");
  EXPECT_EQ(LoadRetired(*store, kRobot)->at(edge).word.reason, "typed wrong");
  EXPECT_EQ(LoadRetired(*store, kRobot)->at(edge).number, 2);
  EXPECT_EQ(*LoadStandingWatermark(*store, kRobot), 2);
  EXPECT_EQ(*LoadNamedReference(*store, kRobot, {}), SensorId("left"));
  EXPECT_FALSE(LoadEdge(*store, edge).value()->measured_at);
  ASSERT_TRUE(RestoreEdge(*store, edge, {{10}, "Ada", ""}));
  EXPECT_THAT(LoadRetired(*store, kRobot).value(), IsEmpty());
}

}  // namespace
}  // namespace rigcal::storage
