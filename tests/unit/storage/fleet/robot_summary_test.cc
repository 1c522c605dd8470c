// Which robots wait for a summary, what is kept of one, and that an older one never takes the place of a newer one.
#include "storage/fleet/robot_summary.h"

#include <gmock/gmock.h>

#include <functional>

#include "server/formats/documents.h"
#include "storage/fleet/fleet_facts.h"
#include "storage/fleet/fleet_list.h"
#include "storage/sessions/retired.h"
#include "storage/sessions/session_estimates.h"
#include "storage/settings/policies.h"
#include "storage/work/attempts.h"
#include "tests/unit/storage/fixture.h"
#include "tests/unit/storage/old_store.h"

namespace rigcal::storage {
namespace {

using testing::ElementsAre;

constexpr Stamp kAskedAt{1'800'000'000'000'000'000};

RobotSummary MakeSummary(const RobotId& robot, int revision) {
  RobotSummary summary;
  summary.robot = robot;
  summary.revision = revision;
  summary.verdict = {VerdictLevel::kWarn, "Sigma of right is 3 mm.", "Take more captures."};
  summary.validity = {Stamp{kAskedAt.ns - 7}, false, UsableRevision{2, Stamp{11}, Stamp{kAskedAt.ns - 7}}, true,
                      "It was given up."};
  summary.sessions = 13, summary.edges = 17, summary.jobs_waiting = 19;
  summary.last_session_at = Stamp{23};
  summary.worst = WorstEdge{SensorId("left"), SensorId("mast"), 4.25};
  summary.causes = {"board_unseen rear", "failed_pair left mast"};
  summary.site = "hall 3", summary.rig_model = "mars-mapper", summary.operator_name = "Ada";
  summary.runs = Runs{1, "It runs revision 1.", "revision 1", {}, Stamp{29}};
  summary.calibrations = {{Stamp{5'000'000'000}, 1.5}, {Stamp{9'000'000'000}}};
  return summary;
}

class RobotSummaryTest : public StoreTest {
 protected:
  // Nobody waits any more.
  void Settle() {
    const std::vector<WaitingSummary> waiting = LoadWaitingSummaries(store_, 100).value();
    for (const WaitingSummary& one : waiting)
      ASSERT_TRUE(ReplaceSummary(store_, MakeSummary(one.robot, 0), one.changes));
    ASSERT_TRUE(LoadWaitingSummaries(store_, 100).value().empty());
  }
  std::vector<std::string> Waiting() {
    const std::vector<WaitingSummary> waiting = LoadWaitingSummaries(store_, 100).value();
    std::vector<std::string> robots;
    for (const WaitingSummary& one : waiting) robots.push_back(one.robot.str());
    return robots;
  }
  std::int64_t Changes() {
    const auto waiting = LoadWaitingSummary(store_, kRobot).value();
    return waiting ? waiting->changes : 0;
  }
  void ExpectWaits(const std::string& after, const std::function<Status()>& change) {
    Settle();
    const Status done = change();
    EXPECT_TRUE(done) << after << ": " << WordsOf(done.error());
    EXPECT_THAT(Waiting(), ElementsAre(kRobot.str())) << after;
  }
};

TEST_F(RobotSummaryTest, WhateverASummarySaysMakesItsRobotWait) {
  ASSERT_TRUE(AppendRobot(store_, RobotId("other"), {1}));
  ExpectWaits("robot", [&] { return AppendRobot(store_, kRobot, {1}); });
  const Manifest manifest = MakeManifest(2);
  const SessionId session = IdOf(manifest);
  ExpectWaits("session",
              [&] { return AppendSession(store_, session, formats::WriteManifest(manifest), manifest, {2}); });
  ASSERT_TRUE(AppendHeld(store_, session, {0, 1}, {3}));
  const SensorPair pair{SensorId("left"), SensorId("right")};
  ExpectWaits("a session that is closed, with a job", [&] { return CloseSession(store_, session, {pair}, {4}); });
  const JobRow job = LoadNextJob(store_, {}).value().value();
  ExpectWaits("a job that is done", [&] { return FinishJob(store_, job.number, {5}); });
  Edge edge = MakeEdge(1);
  edge.session = session, edge.frame_a = pair.a, edge.frame_b = pair.b;
  ExpectWaits("an edge", [&] { return AppendEdge(store_, edge, {6}); });
  ExpectWaits("a job once more", [&] { return QueueAgain(store_, edge.id); });
  SessionEstimate estimate;
  estimate.session = session, estimate.reference = SensorId("left");
  ExpectWaits("a refinement", [&] { return AppendSessionEstimate(store_, estimate, "joint/1", {7}); });
  ExpectWaits("a word about what counts", [&] { return RetireEdge(store_, edge.id, {{8}, "Ada", "typed wrong"}); });
  ExpectWaits("a revision", [&]() -> Status {
    RIGCAL_TRY(AppendRevision(store_, MakeRevision(1)));
    return {};
  });
  ExpectWaits("a policy that waits for it", [&]() -> Status {
    RIGCAL_TRY(
        AppendPolicy(store_, {PolicyScope::kRobot, kRobot.str()}, "tolerance_mm: 4", {{9}, "Ada", "new mounts"}));
    return {};
  });
  ExpectWaits("its worst edge", [&] { return AppendWorstEdge(store_, {kRobot, 1}, {pair.a, pair.b, 1.5}); });
  ExpectWaits("its causes", [&] { return AppendCauseKeys(store_, {kRobot, 1}, {"short_session"}); });
}

TEST_F(RobotSummaryTest, AnAttemptAtARevisionThatEndsWithoutOneIsAChange) {
  const std::string work = WorkOfRevision(kRobot, 7, 8);
  ASSERT_TRUE(AppendRobot(store_, kRobot, {1}));
  ASSERT_TRUE(AppendRobot(store_, RobotId("mapper"), {1}));
  for (const AttemptEnd end : {AttemptEnd::kFailed, AttemptEnd::kCutOff}) {
    Settle();
    ASSERT_TRUE(BeginAttempt(store_, work, {2}));
    EXPECT_THAT(Waiting(), ElementsAre());
    ASSERT_TRUE(EndAttempt(store_, work, end, "no memory", {3}));
    EXPECT_THAT(Waiting(), ElementsAre(kRobot.str()));
  }
  Settle();
  for (const std::string& other : {WorkOfJob(7), WorkOfReport({kRobot, 7}), WorkOfRevision(RobotId("nobody"), 7, 8)}) {
    ASSERT_TRUE(BeginAttempt(store_, other, {4}));
    ASSERT_TRUE(EndAttempt(store_, other, AttemptEnd::kFailed, "", {5}));
  }
  ASSERT_TRUE(BeginAttempt(store_, work, {6}));
  ASSERT_TRUE(EndAttempt(store_, work, AttemptEnd::kDone, "", {7}));  // with a revision, which is a change
  EXPECT_THAT(Waiting(), ElementsAre());
}

TEST_F(RobotSummaryTest, ABatchThatIsNotWholeIsAChangeUntilThereIsARevision) {
  const BatchId batch(DigestOf("batch").str()), another(DigestOf("another").str());
  const auto append = [&](const BatchId& id, int item) {
    return store_.Write([&]() -> Status {
      RIGCAL_TRY(AppendBatch(store_, kRobot, id, 3, {item + 1}));
      return AppendBatchItems(store_, id, {{item, MakeEdge(item)}}, {item + 1});
    });
  };
  for (int item = 0; item < 3; ++item) ExpectWaits("item " + std::to_string(item), [&] { return append(batch, item); });
  ASSERT_TRUE(AppendRevision(store_, MakeRevision(3)));
  Settle();
  ASSERT_TRUE(append(another, 0));
  EXPECT_THAT(Waiting(), ElementsAre());
}

TEST_F(RobotSummaryTest, AllOfASummaryComesBack) {
  ASSERT_TRUE(AppendRobot(store_, kRobot, {1}));
  const RobotSummary made = MakeSummary(kRobot, 3);
  ASSERT_TRUE(ReplaceSummary(store_, made, Changes()));
  const auto loaded = LoadSummaries(store_, RobotId(), std::nullopt, kAskedAt);
  ASSERT_TRUE(loaded && loaded->size() == 1) << WordsOf(loaded);
  const RobotSummary& summary = loaded->front();
  EXPECT_EQ(summary.robot, kRobot);
  EXPECT_EQ(summary.revision, 3);
  EXPECT_EQ(summary.verdict.level, VerdictLevel::kWarn);
  EXPECT_EQ(summary.verdict.why, made.verdict.why);
  EXPECT_EQ(summary.verdict.what_to_do, made.verdict.what_to_do);
  EXPECT_EQ(summary.validity.calibrated_at, made.validity.calibrated_at);
  EXPECT_EQ(summary.validity.usable, made.validity.usable);
  EXPECT_TRUE(summary.validity.calculating);
  EXPECT_EQ(summary.validity.given_up, made.validity.given_up);
  EXPECT_EQ(summary.sessions, 13);
  EXPECT_EQ(summary.edges, 17);
  EXPECT_EQ(summary.jobs_waiting, 19);
  EXPECT_EQ(summary.last_session_at, made.last_session_at);
  ASSERT_TRUE(summary.worst);
  EXPECT_EQ(summary.worst->frame_a, SensorId("left"));
  EXPECT_EQ(summary.worst->frame_b, SensorId("mast"));
  EXPECT_EQ(summary.worst->in_sigmas, 4.25);
  EXPECT_EQ(summary.causes, made.causes);
  EXPECT_EQ(summary.site, "hall 3");
  EXPECT_EQ(summary.rig_model, "mars-mapper");
  EXPECT_EQ(summary.operator_name, "Ada");
  EXPECT_EQ(summary.calibrations, made.calibrations);
  EXPECT_EQ(summary.runs, made.runs);
}

TEST_F(RobotSummaryTest, OverdueIsAsOfTheQuestion) {
  ASSERT_TRUE(AppendRobot(store_, kRobot, {1}));
  RobotSummary summary = MakeSummary(kRobot, 3);
  const auto overdue = [&](std::int64_t at_ns) {
    return LoadSummaries(store_, RobotId(), std::nullopt, {at_ns}).value().front().validity.overdue;
  };
  const std::int64_t until_ns = summary.validity.calibrated_at->ns + kDefaultMaxAge_ns;
  ASSERT_TRUE(ReplaceSummary(store_, summary, 1));
  EXPECT_FALSE(overdue(until_ns));
  EXPECT_TRUE(overdue(until_ns + 1));
  summary.validity.calibrated_at.reset();
  ASSERT_TRUE(ReplaceSummary(store_, summary, 2));
  EXPECT_TRUE(overdue(0)) << "it counts nothing";
  summary.revision = 0;
  ASSERT_TRUE(ReplaceSummary(store_, summary, 3));
  EXPECT_FALSE(overdue(until_ns + 1)) << "there is no revision";
}

TEST_F(RobotSummaryTest, WhatCameMeanwhileMakesItWaitOn) {
  ASSERT_TRUE(AppendRobot(store_, kRobot, {1}));
  const std::int64_t before = Changes();
  ASSERT_TRUE(AppendEdge(store_, MakeEdge(1), {2}));
  const std::int64_t after = Changes();
  EXPECT_GT(after, before);
  ASSERT_TRUE(ReplaceSummary(store_, MakeSummary(kRobot, 1), before));
  EXPECT_EQ(Changes(), after) << "the edge is in no summary";
  ASSERT_TRUE(ReplaceSummary(store_, MakeSummary(kRobot, 2), after));
  EXPECT_THAT(Waiting(), ElementsAre());
}

// Two threads work out the same robot, and the one with the older snapshot stores last.
TEST_F(RobotSummaryTest, AnOlderOneNeverTakesThePlaceOfANewerOne) {
  ASSERT_TRUE(AppendRobot(store_, kRobot, {1}));
  const std::int64_t older = Changes();
  ASSERT_TRUE(AppendEdge(store_, MakeEdge(1), {2}));
  ASSERT_TRUE(ReplaceSummary(store_, MakeSummary(kRobot, 2), Changes()));
  ASSERT_TRUE(ReplaceSummary(store_, MakeSummary(kRobot, 1), older));
  EXPECT_EQ(LoadSummaries(store_, RobotId(), std::nullopt, kAskedAt)->front().revision, 2);
  ASSERT_TRUE(AppendEdge(store_, MakeEdge(2), {3}));
  ASSERT_TRUE(ReplaceSummary(store_, MakeSummary(kRobot, 1), older));
  EXPECT_EQ(LoadSummaries(store_, RobotId(), std::nullopt, kAskedAt)->front().revision, 2);
  EXPECT_THAT(Waiting(), ElementsAre(kRobot.str())) << "the second edge is in neither";
}

TEST_F(RobotSummaryTest, ListsGoOnAfterARobot) {
  for (const char* name : {"c", "a", "B", "d"}) ASSERT_TRUE(AppendRobot(store_, RobotId(name), {1}));
  Settle();
  const auto list = [&](const std::string& after, std::optional<std::int64_t> max) {
    const std::vector<RobotSummary> rows = LoadSummaries(store_, RobotId(after), max, kAskedAt).value();
    std::string names;
    for (const RobotSummary& row : rows) names += row.robot.str();
    return names;
  };
  EXPECT_EQ(list("", std::nullopt), "Bacd");  // byte by byte
  EXPECT_EQ(list("", 2), "Ba");
  EXPECT_EQ(list("a", 2), "cd");
  EXPECT_EQ(list("b", 1), "c") << "a robot that is not there";
  EXPECT_EQ(list("d", 9), "");
}

TEST_F(RobotSummaryTest, TheSizeOfTheFleetIsThatOfItsTables) {
  const auto expect = [&](std::int64_t robots, std::int64_t sessions, std::int64_t edges, std::int64_t unfinished) {
    const FleetSize size = LoadFleetSize(store_).value();
    EXPECT_EQ(size.robots, robots);
    EXPECT_EQ(size.sessions, sessions);
    EXPECT_EQ(size.edges, edges);
    EXPECT_EQ(size.unfinished, unfinished);
  };
  expect(0, 0, 0, 0);
  for (int again = 0; again < 2; ++again) {
    ASSERT_TRUE(AppendRobot(store_, RobotId("quiet"), {1}));
    AppendOpenSession(store_, 1);
    AppendOpenSession(store_, 2);
    for (int i = 0; i < 3; ++i) ASSERT_TRUE(AppendEdge(store_, MakeEdge(i), {1}));
  }
  expect(2, 2, 3, 1);  // to solve
  ASSERT_FALSE(store_.Write([&]() -> Status {
    RIGCAL_TRY(AppendEdge(store_, MakeEdge(4), {1}));
    return Fail(ErrorCode::kInternal, "rolled back", "");
  }));
  ASSERT_TRUE(AppendRevision(store_, MakeRevision(3)));
  expect(2, 2, 3, 1);  // to publish
  ASSERT_TRUE(AppendPublication(store_, {kRobot, 1}, {2}));
  expect(2, 2, 3, 0);
}

TEST_F(RobotSummaryTest, TheNumbersOfARobotAreThoseOfItsTables) {
  const auto expect = [&](const RobotId& robot, std::int64_t sessions, std::int64_t edges) {
    const RobotRow row = LoadRobot(store_, robot).value().value();
    EXPECT_EQ(row.sessions, sessions) << robot.str();
    EXPECT_EQ(row.edges, edges) << robot.str();
    EXPECT_EQ(CountEdges(store_, robot, LoadEdgeWatermark(store_, robot).value()).value(), edges) << robot.str();
  };
  const RobotId other("other");
  const BatchId batch(DigestOf("batch").str());
  for (int again = 0; again < 2; ++again) {
    AppendOpenSession(store_, 1);
    AppendOpenSession(store_, 1, other);
    AppendOpenSession(store_, 2, other);
    for (int i = 0; i < 3; ++i) ASSERT_TRUE(AppendEdge(store_, MakeEdge(i), {1}));
  }
  const auto append = [&](int item) {
    return store_.Write([&]() -> Status {
      RIGCAL_TRY(AppendBatch(store_, other, batch, 2, {2}));
      return AppendBatchItems(store_, batch, {{item, MakeEdge(item, other)}}, {2});
    });
  };
  ASSERT_TRUE(append(0));
  expect(kRobot, 1, 3);
  expect(other, 2, 0);  // the batch is not whole
  ASSERT_TRUE(append(1));
  ASSERT_FALSE(store_.Write([&]() -> Status {
    RIGCAL_TRY(AppendEdge(store_, MakeEdge(4), {1}));
    return Fail(ErrorCode::kInternal, "rolled back", "");
  }));
  expect(kRobot, 1, 3);
  expect(other, 2, 2);
  EXPECT_EQ(CountEdges(store_, kRobot, 2).value(), 2);
  EXPECT_EQ(CountEdges(store_, RobotId("nobody"), 2).value(), 0);
}

TEST_F(RobotSummaryTest, ThoseThatWaitComeInTurn) {
  for (const char* name : {"b", "a", "d", "c"}) ASSERT_TRUE(AppendRobot(store_, RobotId(name), {1}));
  const auto names = [&](int max, const std::string& after) {
    std::string text;
    const std::vector<WaitingSummary> waiting = LoadWaitingSummaries(store_, max, RobotId(after)).value();
    for (const WaitingSummary& one : waiting) text += one.robot.str();
    return text;
  };
  EXPECT_EQ(names(3, ""), "abc");
  EXPECT_EQ(names(3, "b"), "cda");
  EXPECT_EQ(names(9, "bb"), "cdab");
  EXPECT_EQ(names(2, "d"), "ab");
}

// Version 15, which knew no summaries. The numbers of its edges have gaps: it was of version 4 once.
std::string StoreOfVersion15() {
  std::string sql = EmptyStoreOfVersion(15);
  sql +=
      "INSERT INTO robot VALUES ('r', 1), ('s', 2);"
      "INSERT INTO session VALUES (1, 's1', 'r', 10, 1, '', 0, 5, '{}');";
  for (const char* number : {"3", "8"})
    sql += std::string(
               "INSERT INTO edge (number, edge_id, robot_id, epoch, frame_a, frame_b, method, state, appended_ns) "
               "VALUES (") +
           number + ", printf('%064d', " + number + "), 'r', 1, 'left', 'right', 'stereo', 'failed', 5);" +
           "INSERT INTO counted_edge VALUES (" + number + ", " + number + ", 'r');";
  return sql;
}

TEST(RobotSummaryMigration, AllRobotsOfVersion15Wait) {
  const TempFolder folder;
  MakeDatabase(folder.path(), StoreOfVersion15());
  Result<Store> store = Store::Open(folder.path());
  ASSERT_TRUE(store) << WordsOf(store);
  const auto waiting = LoadWaitingSummaries(*store, 100);
  ASSERT_TRUE(waiting && waiting->size() == 2) << WordsOf(waiting);
  EXPECT_EQ((*waiting)[0].robot, RobotId("r"));
  EXPECT_EQ((*waiting)[1].robot, RobotId("s"));
  const FleetSize size = LoadFleetSize(*store).value();
  EXPECT_EQ(size.robots, 2);
  EXPECT_EQ(size.sessions, 1);
  EXPECT_EQ(size.edges, 2);
  const RobotRow r = LoadRobot(*store, RobotId("r")).value().value(),
                 s = LoadRobot(*store, RobotId("s")).value().value();
  EXPECT_EQ(r.sessions, 1);
  EXPECT_EQ(r.edges, 2);
  EXPECT_EQ(s.sessions + s.edges, 0);
  EXPECT_TRUE(LoadSummaries(*store, RobotId(), std::nullopt, kAskedAt)->empty());
  ASSERT_TRUE(ReplaceSummary(*store, MakeSummary(RobotId("r"), 1), (*waiting)[0].changes));
  EXPECT_EQ(LoadWaitingSummaries(*store, 100)->size(), 1u);
}

}  // namespace
}  // namespace rigcal::storage
