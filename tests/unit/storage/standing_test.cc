// What counts: the newest word about sessions of the same pictures, and retired edges.
#include "storage/sessions/standing.h"

#include <gmock/gmock.h>

#include <random>

#include "server/formats/documents.h"
#include "storage/sessions/retired.h"
#include "storage/sessions/session_estimates.h"
#include "tests/unit/storage/fixture.h"
#include "tests/unit/storage/old_store.h"

namespace rigcal::storage {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Pair;
using testing::UnorderedElementsAre;

class StandingTest : public StoreTest {
 protected:
  // A closed session of the pictures [from, to) of one robot; `note` makes it another session.
  SessionId Push(int from, int to, const std::string& note, Stamp at, const RobotId& robot = kRobot) {
    Manifest manifest = MakeManifest(static_cast<std::size_t>(to), robot);
    manifest.payloads.erase(manifest.payloads.begin(), manifest.payloads.begin() + from);
    manifest.header.operator_name = note;
    const std::string text = formats::WriteManifest(manifest);
    const SessionId id(Sha256Of(text).str());
    std::vector<std::uint32_t> all(manifest.payloads.size());
    for (std::uint32_t i = 0; i < all.size(); ++i) all[i] = i;
    EXPECT_TRUE(AppendSession(store_, id, text, manifest, at));
    EXPECT_TRUE(AppendHeld(store_, id, all, at));
    EXPECT_TRUE(CloseSession(store_, id, {}, at));
    return id;
  }
  std::map<SessionId, SessionId> Superseded(const RobotId& robot = kRobot) {
    std::map<SessionId, SessionId> by;
    const auto loaded = LoadSuperseded(store_, robot);
    EXPECT_TRUE(loaded) << WordsOf(loaded);
    for (const auto& [old, superseding] : *loaded) by[old] = superseding.by;
    return by;
  }
  bool Restore(const SessionId& id, std::int64_t at_ns = 100) {
    const auto made = MakeCurrent(store_, id, MadeCurrent::kRestored, {{at_ns}, "Ada", "wrong squares"});
    EXPECT_TRUE(made) << WordsOf(made);
    return made.value_or(false);
  }
  std::vector<std::string> Audit() { return ColumnIn(store_, "SELECT who || ' ' || what FROM audit ORDER BY number"); }
};

TEST_F(StandingTest, TheNewestPushOfTheSamePicturesIsCurrent) {
  const SessionId right = Push(0, 4, "right", {1});
  EXPECT_THAT(Superseded(), IsEmpty());
  const SessionId wrong = Push(0, 4, "wrong", {2});
  EXPECT_THAT(Superseded(), ElementsAre(Pair(right, wrong)));
  EXPECT_TRUE(MakeCurrent(store_, right, MadeCurrent::kPushedAgain, {{3}, "robot mapper-01", ""}).value());
  EXPECT_THAT(Superseded(), ElementsAre(Pair(wrong, right)));
  const Superseding by = LoadSuperseded(store_, kRobot)->at(wrong);
  EXPECT_EQ(by.standing.how, "pushed_again");
  EXPECT_EQ(by.standing.word.at, Stamp{3});
  EXPECT_EQ(by.operator_name, "right");
  EXPECT_THAT(Audit(), ElementsAre("robot mapper-01 pushed again session " + right.str() +
                                   " of robot mapper-01, superseded by session " + wrong.str()));
}

TEST_F(StandingTest, SayingItTwiceIsSayingItOnce) {
  const SessionId right = Push(0, 4, "right", {1});
  EXPECT_FALSE(Restore(right));  // nothing superseded it
  const SessionId wrong = Push(0, 4, "wrong", {2});
  EXPECT_FALSE(Restore(wrong));
  EXPECT_TRUE(Restore(right));
  const std::int64_t watermark = LoadStandingWatermark(store_, kRobot).value();
  EXPECT_FALSE(Restore(right, 999));
  EXPECT_EQ(LoadStandingWatermark(store_, kRobot).value(), watermark);
  EXPECT_EQ(LoadStanding(store_, right).value()->word.at, Stamp{100});
  EXPECT_EQ(LoadStanding(store_, right).value()->word.reason, "wrong squares");
  EXPECT_EQ(Audit().size(), 1u);
  Store reopened = Open();
  EXPECT_EQ(LoadSuperseded(reopened, kRobot)->at(wrong).by, right);
}

// A smaller set of the same pictures that is restored supersedes the larger one, though it holds no half of it.
TEST_F(StandingTest, ARestoredSessionSupersedesWhatSupersededIt) {
  const SessionId few = Push(0, 4, "few", {1});
  const SessionId many = Push(0, 10, "many", {2});
  EXPECT_THAT(Superseded(), ElementsAre(Pair(few, many)));
  EXPECT_TRUE(Restore(few));
  EXPECT_THAT(Superseded(), ElementsAre(Pair(many, few)));
  EXPECT_TRUE(Restore(many, 200));
  EXPECT_THAT(Superseded(), ElementsAre(Pair(few, many)));
}

TEST_F(StandingTest, LessThanHalfOfThePicturesAreAnotherVisit) {
  Push(0, 10, "first", {1});
  Push(6, 20, "second", {2});
  EXPECT_THAT(Superseded(), IsEmpty());
}

TEST_F(StandingTest, OfThreeTheNewestWordSupersedesBothOthers) {
  const SessionId a = Push(0, 4, "a", {1}), b = Push(0, 4, "b", {2}), c = Push(0, 4, "c", {3});
  EXPECT_THAT(Superseded(), UnorderedElementsAre(Pair(a, c), Pair(b, c)));
  EXPECT_TRUE(Restore(a));
  EXPECT_THAT(Superseded(), UnorderedElementsAre(Pair(b, a), Pair(c, a)));
}

TEST_F(StandingTest, RobotsDoNotSupersedeEachOther) {
  const RobotId other("mapper-02");
  Push(0, 4, "a", {1});
  Manifest manifest = MakeManifest(4);
  manifest.header.robot = other;
  const std::string text = formats::WriteManifest(manifest);
  const SessionId theirs(Sha256Of(text).str());
  ASSERT_TRUE(AppendSession(store_, theirs, text, manifest, {2}));
  ASSERT_TRUE(AppendHeld(store_, theirs, {0, 1, 2, 3}, {2}));
  ASSERT_TRUE(CloseSession(store_, theirs, {}, {2}));
  EXPECT_THAT(Superseded(RobotId()), IsEmpty());
}

TEST_F(StandingTest, OnlyAWholeSessionCanBeMadeCurrent) {
  const SessionId open = AppendOpenSession(store_, 3);
  const Word word{{1}, "Ada", ""};
  EXPECT_EQ(MakeCurrent(store_, open, MadeCurrent::kRestored, word).error().code, ErrorCode::kConflict);
  const SessionId unknown(DigestOf("unknown").str());
  EXPECT_EQ(MakeCurrent(store_, unknown, MadeCurrent::kRestored, word).error().code, ErrorCode::kNotFound);
  EXPECT_EQ(MakeCurrent(store_, open, MadeCurrent::kRestored, {{1}, "Ada", "two\nlines"}).error().code,
            ErrorCode::kInvalidInput);
  EXPECT_FALSE(LoadStanding(store_, open).value().has_value());
}

// What was superseded or retired takes no place of those that are estimated, whatever was said in which order.
TEST_F(StandingTest, TheNewestThatAreEstimatedAreThoseThatCount) {
  std::vector<SessionId> pushed;
  const auto counting = [&] {
    const auto superseded = LoadSuperseded(store_, kRobot).value();
    const auto retired = LoadRetiredSessions(store_, kRobot).value();
    std::vector<SessionId> ids;
    for (const SessionId& id : pushed)
      if (!superseded.contains(id) && !retired.contains(id)) ids.push_back(id);
    std::sort(ids.rbegin(), ids.rend());  // all were captured at one time
    return ids;
  };
  const auto estimated = [&](int most) {
    std::vector<SessionId> ids;
    const auto bases = LoadSessionBases(store_, kRobot, most).value();
    for (const SessionBasis& basis : bases) ids.push_back(basis.session);
    return ids;
  };
  const auto retire = [&](const SessionId& id, std::int64_t at_ns) {
    EXPECT_TRUE(RetireSession(store_, id, {{at_ns}, "Ada", "blurred"}));
  };
  std::mt19937 random(3);
  for (int step = 0; step < 60; ++step) {
    const auto any = [&] { return pushed[random() % pushed.size()]; };
    const unsigned what = pushed.size() < 3 ? 0 : random() % 4;
    if (what == 0)
      pushed.push_back(
          Push(static_cast<int>(random() % 3), 4 + static_cast<int>(random() % 3), std::to_string(step), {step}));
    if (what == 1) retire(any(), step);
    if (what == 2) static_cast<void>(Restore(any(), step));
    if (what == 3)
      static_cast<void>(MakeCurrent(store_, any(), MadeCurrent::kPushedAgain, {{step}, "robot mapper-01", ""}).value());
    std::vector<SessionId> wanted = counting();
    ASSERT_EQ(estimated(100), wanted) << "step " << step;
    wanted.resize(std::min<std::size_t>(wanted.size(), 1));
    ASSERT_EQ(estimated(1), wanted) << "step " << step;
  }
}

TEST_F(StandingTest, AnEdgeIsRetiredOnceAndTheFirstWordHolds) {
  const EdgeId id = MakeEdge(1).id;
  EXPECT_EQ(RetireEdge(store_, id, {{1}, "Ada", "x"}).error().code, ErrorCode::kNotFound);
  ASSERT_TRUE(AppendEdge(store_, MakeEdge(1), {1}));
  ASSERT_TRUE(AppendEdge(store_, MakeEdge(2), {1}));
  ASSERT_TRUE(RetireEdge(store_, id, {{5}, "Ada", "typed 1.2 for 0.12"}));
  ASSERT_TRUE(RetireEdge(store_, id, {{6}, "Bob", "me too"}));
  ASSERT_TRUE(AppendEdge(store_, MakeEdge(1), {7}));  // pushed again
  const auto retired = LoadRetired(store_, kRobot).value();
  ASSERT_EQ(retired.size(), 1u);
  EXPECT_EQ(retired.at(id).word.who, "Ada");
  EXPECT_EQ(retired.at(id).word.reason, "typed 1.2 for 0.12");
  EXPECT_THAT(LoadRetired(store_, RobotId("mapper-02")).value(), IsEmpty());
  EXPECT_THAT(Audit(), ElementsAre(HasSubstr("Ada retired edge " + id.str())));
}

TEST_F(StandingTest, ARobotWithEdgesIsUnsolvedUntilARevisionCountsTheNewestWord) {
  const auto unsolved = [&] { return LoadUnsolvedRobots(store_).value(); };
  const auto revise = [&] {
    Revision revision = MakeRevision(LoadEdgeWatermark(store_, kRobot).value());
    revision.standing_watermark = LoadStandingWatermark(store_, kRobot).value();
    EXPECT_TRUE(AppendRevision(store_, revision));
  };
  const SessionId right = Push(0, 4, "right", {1});
  EXPECT_THAT(unsolved(), IsEmpty());  // there is nothing to solve
  ASSERT_TRUE(AppendEdge(store_, MakeEdge(1), {1}));
  EXPECT_THAT(unsolved(), ElementsAre(kRobot));
  revise();
  EXPECT_THAT(unsolved(), IsEmpty());
  Push(0, 4, "wrong", {2});
  EXPECT_THAT(unsolved(), ElementsAre(kRobot));
  revise();
  Restore(right);
  EXPECT_THAT(unsolved(), ElementsAre(kRobot));
  Store reopened = Open();  // after a crash between the word and the revision as well
  EXPECT_THAT(LoadUnsolvedRobots(reopened).value(), ElementsAre(kRobot));
  revise();
  ASSERT_TRUE(RetireEdge(store_, MakeEdge(1).id, {{9}, "Ada", "x"}));
  EXPECT_THAT(unsolved(), ElementsAre(kRobot));
  revise();
  EXPECT_THAT(unsolved(), IsEmpty());
  EXPECT_EQ(LoadRevision(store_, kRobot, 0).value()->standing_watermark, LoadStandingWatermark(store_, kRobot).value());
}

TEST_F(StandingTest, AThingIsNamedByItsFirstDigits) {
  const SessionId id = Push(0, 1, "a", {1});
  Push(1, 2, "b", {1});
  EXPECT_THAT(FindSessions(store_, id.str().substr(0, 8), RobotId()).value(), ElementsAre(id));
  EXPECT_THAT(FindSessions(store_, id.str(), kRobot).value(), ElementsAre(id));
  EXPECT_THAT(FindSessions(store_, id.str(), RobotId("mapper-02")).value(), IsEmpty());
  for (const char* bad : {"", "1234567", "0123456G", "01234567%"})
    EXPECT_EQ(FindSessions(store_, bad, RobotId()).error().code, ErrorCode::kInvalidInput) << bad;
  ASSERT_TRUE(AppendEdge(store_, MakeEdge(1), {1}));
  EXPECT_THAT(FindEdges(store_, MakeEdge(1).id.str().substr(0, 12), RobotId()).value(), ElementsAre(MakeEdge(1).id));
}

// A store of the fourth version: its sessions stand in the order in which they came, and nothing is to be solved anew.
TEST(StandingMigration, AnOlderStoreKeepsWhatCounted) {
  const TempFolder folder;
  std::string sql = EmptyStoreOfVersion(4);
  sql += "INSERT INTO robot VALUES ('mapper-01', 1), ('mapper-02', 1);";
  const auto session = [&](int number, const std::string& robot) {
    const std::string n = std::to_string(number);
    sql += "INSERT INTO session VALUES (" + n + ", printf('%064d', " + n + "), '" + robot +
           "', 1, 2, 'Ada', 1, 5, '{}');" + "INSERT INTO payload VALUES (" + n +
           ", 0, 'left/1.png', printf('%064d', 77), 5);" + "INSERT INTO payload_held VALUES (" + n + ", 0, 3);" +
           "INSERT INTO session_closed VALUES (" + n + ", 4);";
  };
  session(1, "mapper-01");
  session(2, "mapper-01");
  sql +=
      "INSERT INTO digest_held VALUES (printf('%064d', 77), 3);"
      "INSERT INTO edge (number, edge_id, robot_id, epoch, frame_a, frame_b, method, state, appended_ns) VALUES "
      "(1, printf('%064d', 8), 'mapper-01', 1, 'left', 'right', 'stereo', 'failed', 5);"
      "INSERT INTO revision VALUES ('mapper-01', 1, 9, 1, 'pass', '', '', printf('%064d', 9), '{}');";
  MakeDatabase(folder.path(), sql);
  Result<Store> store = Store::Open(folder.path());
  ASSERT_TRUE(store) << WordsOf(store);
  const SessionId first(std::string(63, '0') + "1"), second(std::string(63, '0') + "2");
  const auto superseded = LoadSuperseded(*store, kRobot);
  ASSERT_TRUE(superseded) << WordsOf(superseded);
  ASSERT_EQ(superseded->size(), 1u);
  EXPECT_EQ(superseded->at(first).by, second);
  EXPECT_THAT(LoadUnsolvedRobots(*store).value(), IsEmpty());
  const Digest digest(std::string(62, '0') + "77");
  EXPECT_TRUE(IsHeld(*store, kRobot, digest).value());
  EXPECT_FALSE(IsHeld(*store, RobotId("mapper-02"), digest).value());
  ASSERT_TRUE(MakeCurrent(*store, first, MadeCurrent::kRestored, {{10}, "Ada", ""}).value());
  EXPECT_THAT(LoadUnsolvedRobots(*store).value(), ElementsAre(kRobot));
}

}  // namespace
}  // namespace rigcal::storage
