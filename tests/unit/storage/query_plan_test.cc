// A question about one robot looks at rows of that robot: no statement of it walks through a whole table. The list of
// all robots is counted and sorted by an index that holds no words.
#include <SQLiteCpp/SQLiteCpp.h>
#include <sqlite3.h>

#include <map>

#include "server/formats/documents.h"
#include "storage/alerts/outbox.h"
#include "storage/audit.h"
#include "storage/database/query.h"
#include "storage/edges/edges.h"
#include "storage/fleet/calibration_series.h"
#include "storage/fleet/fleet_facts.h"
#include "storage/fleet/fleet_list.h"
#include "storage/fleet/robot_runs.h"
#include "storage/fleet/robot_status.h"
#include "storage/fleet/robot_summary.h"
#include "storage/revisions/as_found.h"
#include "storage/revisions/decisions.h"
#include "storage/revisions/merged_edges.h"
#include "storage/revisions/revision_poses.h"
#include "storage/revisions/revisions.h"
#include "storage/sessions/epochs.h"
#include "storage/sessions/retired.h"
#include "storage/sessions/sessions.h"
#include "storage/sessions/standing.h"
#include "storage/settings/policies.h"
#include "storage/settings/rig_models.h"
#include "storage/work/jobs.h"
#include "tests/unit/storage/fixture.h"

namespace rigcal::storage {
namespace {

class QueryPlanTest : public StoreTest {
 protected:
  void SetUp() override {
    if (!IsOnSqlite()) GTEST_SKIP() << "asks SQLite for its plans";
    const SensorPair pair{SensorId("left"), SensorId("right")};
    const SessionId session = AppendClosedSession(store_, 2, {pair});
    for (const RobotId& robot : {kRobot, RobotId("b"), RobotId("c"), RobotId("d")}) {
      ASSERT_TRUE(AppendRobot(store_, robot, {1}));
      for (int i = 0; i < 3; ++i) ASSERT_TRUE(AppendEdge(store_, MakeEdge(i, robot), {1}));
      ASSERT_TRUE(AppendRevision(store_, MakeRevision(LoadEdgeWatermark(store_, robot).value(), robot)));
      ASSERT_TRUE(AppendDecision(store_, robot, 1, Deciding::kApprove, {{1}, "policy", ""}));
    }
    session_ = session;
    ASSERT_TRUE(RetireSensor(store_, kRobot, SensorId("s1"), {{2}, "Ada", "taken off"}));
    ASSERT_TRUE(RetireSession(store_, session, {{2}, "Ada", "blurred"}));
  }

  // Rows that a statement stepped through without an index, by its text. A CROSS JOIN from a queue is meant: it holds
  // only what is still to be done.
  std::map<std::string, int> Scanned() {
    std::map<std::string, int> scanned;
    sqlite3* database = store_.database().getHandle();
    for (sqlite3_stmt* one = sqlite3_next_stmt(database, nullptr); one != nullptr;
         one = sqlite3_next_stmt(database, one))
      if (const int steps = sqlite3_stmt_status(one, SQLITE_STMTSTATUS_FULLSCAN_STEP, 1); steps > 0)
        scanned[sqlite3_sql(one)] = steps;
    return scanned;
  }

  // Steps of all statements since this was asked last.
  std::int64_t Steps() {
    std::int64_t steps = 0;
    sqlite3* database = store_.database().getHandle();
    for (sqlite3_stmt* one = sqlite3_next_stmt(database, nullptr); one != nullptr;
         one = sqlite3_next_stmt(database, one))
      steps += sqlite3_stmt_status(one, SQLITE_STMTSTATUS_VM_STEP, 1);
    return steps;
  }

  std::string PlanOf(const std::string& sql) {
    std::string plan;
    SQLite::Statement query(store_.database(), "EXPLAIN QUERY PLAN " + sql);
    while (query.executeStep()) plan += query.getColumn(3).getString() + "; ";
    return plan;
  }
  void SumUpAll() {
    const std::vector<WaitingSummary> waiting = LoadWaitingSummaries(store_, 100).value();
    for (const WaitingSummary& one : waiting) {
      RobotSummary summary;
      summary.robot = one.robot;
      summary.causes = {"board_unseen rear", "short_session"};
      ASSERT_TRUE(ReplaceSummary(store_, summary, one.changes));
    }
  }

  SessionId session_;
};

TEST_F(QueryPlanTest, QuestionsWhetherARobotIsKnownDoNotScan) {
  (void)Scanned();  // what SetUp left
  EXPECT_TRUE(LoadRobot(store_, kRobot).value());
  EXPECT_TRUE(HasRobot(store_, kRobot).value());
  EXPECT_EQ(LoadRobotNames(store_, "", 2)->size(), 2U);
  EXPECT_EQ(LoadRobotNames(store_, "m", 9)->size(), 1U);
  EXPECT_EQ(LoadRobotsBeside(store_, RobotId("bb"), 1)->size(), 2U);
  EXPECT_EQ(LoadRobotsNamed(store_, {RobotId("d"), RobotId("e")})->size(), 1U);
  for (const auto& [sql, steps] : Scanned()) ADD_FAILURE() << steps << " rows by: " << sql;
}

TEST_F(QueryPlanTest, QuestionsAboutSessionsEdgesAndRevisionsOfOneRobotDoNotScan) {
  (void)Scanned();
  EXPECT_TRUE(LoadOpenSessions(store_, kRobot));
  EXPECT_TRUE(LoadSessions(store_, kRobot));
  EXPECT_TRUE(LoadSession(store_, session_));
  EXPECT_TRUE(CountJobs(store_, kRobot));
  EXPECT_TRUE(CountJobs(store_, session_));
  EXPECT_TRUE(IsUnsolved(store_, kRobot));
  EXPECT_TRUE(LoadUnsolvedSince(store_, kRobot));
  EXPECT_TRUE(CountUnpublished(store_, kRobot));
  EXPECT_TRUE(LoadRevision(store_, kRobot, 0));
  EXPECT_TRUE(LoadRevisionSummary(store_, kRobot, 0));
  EXPECT_EQ(CountEdges(store_, kRobot, LoadEdgeWatermark(store_, kRobot).value()).value(), 3);
  EXPECT_TRUE(LoadRevisionPoses(store_, {kRobot, 1}));
  EXPECT_TRUE(LoadEdgeWatermark(store_, kRobot));
  EXPECT_TRUE(LoadStandingWatermark(store_, kRobot));
  EXPECT_TRUE(LoadEdges(store_, kRobot, true));
  EXPECT_TRUE(LoadUnmergedEdges(store_, kRobot, EdgeParts::kAll));
  EXPECT_TRUE(LoadMergedEdges(store_, kRobot));
  EXPECT_TRUE(IsMergeOutdated(store_, kRobot, *LoadWhatCounts(store_, kRobot)));
  EXPECT_TRUE(LoadListedSensors(store_, kRobot));
  EXPECT_TRUE(LoadHeldByAnother(store_, RobotId("b"), {Digest(std::string(64, 'a'))}));
  EXPECT_TRUE(LoadCapturedAt(store_, kRobot));
  EXPECT_TRUE(LoadNamedReference(store_, kRobot, {SensorId("right")}));
  EXPECT_TRUE(LoadRetired(store_, kRobot));
  EXPECT_TRUE(LoadRetiredSessions(store_, kRobot));
  EXPECT_TRUE(LoadRetiredSensors(store_, kRobot));
  EXPECT_TRUE(HasSensor(store_, kRobot, SensorId("nobody")));
  EXPECT_TRUE(LoadStanding(store_, kRobot, SensorId("left")));
  EXPECT_TRUE(LoadStanding(store_, session_));
  EXPECT_TRUE(IsPublished(store_, {kRobot, 1}));
  EXPECT_EQ(LoadRevisions(store_, kRobot, 2, 1)->size(), 1U);
  EXPECT_EQ(LoadCreatedAt(store_, kRobot, {1, 2})->size(), 1U);
  EXPECT_TRUE(LoadFirstRevisions(store_, kRobot, 9, {session_}));
  EXPECT_EQ(LoadSessions(store_, kRobot, SessionId(), 1)->size(), 1U);
  EXPECT_EQ(LoadSessions(store_, RobotId(), SessionId(), 1)->size(), 1U);  // a page of all robots'
  EXPECT_TRUE(LoadSessions(store_, kRobot, session_, 1)->empty());
  for (const auto& [sql, steps] : Scanned()) ADD_FAILURE() << steps << " rows by: " << sql;
}

TEST_F(QueryPlanTest, QuestionsAboutSingleEdgesAndMergedOnesDoNotScan) {
  (void)Scanned();
  const std::vector<EdgeId> ids = LoadEdgeIds(store_, kRobot, EdgeId(), 2).value();
  EXPECT_EQ(ids.size(), 2U);
  EXPECT_EQ(LoadEdgeIds(store_, kRobot, ids.back(), 2)->size(), 1U);
  EXPECT_EQ(LoadEdges(store_, ids, false)->size(), 2U);
  EXPECT_EQ(LoadCapturedAt(store_, std::vector<SessionId>{session_})->size(), 1U);
  EXPECT_TRUE(LoadSessionFacts(store_, {session_})->empty());
  EXPECT_FALSE(FindRobotOfMerged(store_, ids.front())->has_value());
  EXPECT_TRUE(FindMergedEdges(store_, "0123456789abcdef", kRobot)->empty());
  EXPECT_TRUE(FindMergedEdges(store_, "0123456789abcdef", RobotId())->empty());
  MergedEdge merged;
  merged.frame_a = SensorId("left"), merged.frame_b = SensorId("right"), merged.method = "stereo";
  EXPECT_TRUE(LoadIdsWithin(store_, kRobot, merged)->empty());
  EXPECT_FALSE(*IsToMergeAnew(store_, kRobot, 8));
  for (const auto& [sql, steps] : Scanned()) ADD_FAILURE() << steps << " rows by: " << sql;
}

TEST_F(QueryPlanTest, QuestionsAboutWhatRevisionsToldDoNotScan) {
  (void)Scanned();
  EXPECT_TRUE(LoadNewestCapture(store_, kRobot));
  EXPECT_TRUE(LoadWorstEdge(store_, {kRobot, 1}));
  EXPECT_TRUE(LoadCalibrations(store_, kRobot));
  EXPECT_TRUE(LoadCauseKeys(store_, {kRobot, 1}));
  EXPECT_TRUE(LoadAsFound(store_, {kRobot, 1}));
  EXPECT_TRUE(LoadAsFoundSummaries(store_, kRobot, {1, 2}));
  EXPECT_TRUE(LoadWaitingSummary(store_, kRobot));
  EXPECT_TRUE(LoadRigModel(store_, kRobot));
  EXPECT_TRUE(HasRigModel(store_, "nobody's"));
  EXPECT_TRUE(LoadRigModels(store_, 9));
  EXPECT_TRUE(LoadPolicyWatermark(store_));
  for (const PolicyPlace& place : {PolicyPlace{}, PolicyPlace{PolicyScope::kRobot, kRobot.str()}})
    EXPECT_TRUE(LoadPolicy(store_, place));
  for (const auto& [sql, steps] : Scanned()) ADD_FAILURE() << steps << " rows by: " << sql;
}

// Nor does what was decided, by whom, and what the robot says that it runs.
TEST_F(QueryPlanTest, TheLifeOfACalibrationDoesNotScan) {
  (void)Scanned();
  EXPECT_TRUE(LoadUsableRevision(store_, kRobot).value());
  EXPECT_FALSE(LoadStillUsable(store_, kRobot, 0).value());
  EXPECT_FALSE(IsHeldBack(store_, kRobot, Digest(std::string(64, 'a')), 1).value());
  EXPECT_EQ(LoadNewestApproved(store_, kRobot).value(), 1);
  EXPECT_EQ(LoadInUse(store_, kRobot).value()->revision, 1);
  EXPECT_EQ(LoadDecision(store_, kRobot, 1).value()->how, "approved");
  EXPECT_EQ(LoadRevisionState(store_, LoadRevisionSummary(store_, kRobot, 1)->value(), UsableRevision{1, {}}).value(),
            RevisionState::kApproved);
  EXPECT_TRUE(AppendDecision(store_, kRobot, 1, Deciding::kReject, {{3}, "Ada", "bent"}).value());
  EXPECT_FALSE(LoadAudit(store_, kRobot, 0, 9)->empty());
  EXPECT_EQ(LoadAudit(store_, RobotId(), 2, 9)->size(), 1U);  // a page of all robots'
  EXPECT_TRUE(AppendAudit(store_, {3}, "Ada", "looked"));
  EXPECT_TRUE(AppendRuns(store_, {kRobot, Digest(std::string(64, 'a')), {1}, "agent"}, {2}).value());
  EXPECT_EQ(LoadRuns(store_, kRobot).value()->revision, 0);
  EXPECT_FALSE(WasApproved(store_, kRobot, 9).value());
  EXPECT_TRUE(LoadEpochs(store_, kRobot));
  EXPECT_FALSE(LoadRigModelVersion(store_, "mars").value());
  EXPECT_TRUE(LoadRobotsOfModel(store_, "mars", 10)->empty());
  for (const auto& [sql, steps] : Scanned()) ADD_FAILURE() << steps << " rows by: " << sql;
}

// It is asked several times with every look at a robot.
TEST_F(QueryPlanTest, WhatIsInUseCostsTheSameHoweverOftenWasDecided) {
  const RobotId robot("b");
  const auto cost = [&](int in_use) {
    (void)Steps();
    EXPECT_EQ(LoadUsableRevision(store_, robot).value()->number, in_use);
    return Steps();
  };
  const std::int64_t with_one = cost(1);
  EXPECT_GT(with_one, 0);
  for (int number = 2; number <= 100; ++number) {
    ASSERT_TRUE(AppendRevision(store_, MakeRevision(LoadEdgeWatermark(store_, robot).value(), robot)));
    ASSERT_TRUE(AppendDecision(store_, robot, number, Deciding::kApprove, {{number}, "policy", ""}));
  }
  EXPECT_LE(cost(100), with_one + with_one / 4);
}

TEST_F(QueryPlanTest, PartsAndModelsCostTheSameHoweverManyVisitsThereWere) {
  const auto visit = [&](std::uint32_t pictures) {
    Manifest manifest = MakeManifest(pictures);
    manifest.header.sensors[0].serial = "A1";
    manifest.header.sensors[0].firmware = "2.0";
    std::vector<std::uint32_t> all;
    for (std::uint32_t idx = 0; idx < pictures; ++idx) all.push_back(idx);
    ASSERT_TRUE(AppendSession(store_, IdOf(manifest), formats::WriteManifest(manifest), manifest, {1}));
    ASSERT_TRUE(AppendHeld(store_, IdOf(manifest), all, {1}));
    ASSERT_TRUE(CloseSession(store_, IdOf(manifest), {}, {1}));
  };
  const auto cost = [&] {
    (void)Steps();
    EXPECT_TRUE(LoadEpochs(store_, kRobot)->empty());
    EXPECT_EQ(LoadRobotsOfModel(store_, "stereo-rig", 9)->size(), 1U);
    return Steps();
  };
  visit(3);
  const std::int64_t with_few = cost();
  for (std::uint32_t pictures = 4; pictures < 40; ++pictures) visit(pictures);
  EXPECT_LE(cost(), with_few + with_few / 4);
}

// Every scrape of the metrics asks it.
TEST_F(QueryPlanTest, HowManyAlertsAReceiverHasIsNotCountedAnew) {
  const std::string url = "http://localhost/a";
  ASSERT_TRUE(SetReceivers(store_, {url}, {1}));
  const auto deliver = [&](std::int64_t number) {
    ASSERT_TRUE(AppendAlert(store_, formats::StatusAlert(kRobot, 1, StatusWord::kOk, {}, {1})));
    ASSERT_TRUE(MarkDelivered(store_, url, number, 200, {2}));
  };
  const auto cost = [&](std::int64_t delivered) {
    (void)Steps();
    EXPECT_EQ(LoadReceivers(store_)->front().delivered, delivered);
    return Steps();
  };
  deliver(1);
  const std::int64_t with_one = cost(1);
  for (std::int64_t number = 2; number <= 100; ++number) deliver(number);
  EXPECT_LE(cost(100), with_one + with_one / 4);
}

// How many sessions and edges it has is asked with every summary.
TEST_F(QueryPlanTest, TheNumbersOfARobotCostTheSameWhateverItsHistory) {
  const auto cost = [&](std::int64_t edges) {
    (void)Steps();
    EXPECT_EQ(LoadRobot(store_, kRobot)->value().edges, edges);
    EXPECT_EQ(CountEdges(store_, kRobot, 1'000'000).value(), edges);
    return Steps();
  };
  const std::int64_t with_few = cost(3);
  EXPECT_GT(with_few, 0);
  for (int i = 3; i < 300; ++i) ASSERT_TRUE(AppendEdge(store_, MakeEdge(i), {1}));
  for (std::size_t payloads = 3; payloads < 50; ++payloads) AppendOpenSession(store_, payloads);
  EXPECT_EQ(cost(300), with_few);
  EXPECT_EQ(LoadRobot(store_, kRobot)->value().sessions, 48);
}

// Nor does what open pages ask every second, a part of the list, or the queues' heads.
TEST_F(QueryPlanTest, PartsOfTheFleetDoNotScan) {
  SumUpAll();
  (void)Scanned();
  EXPECT_EQ(LoadFleetSize(store_)->robots, 4);
  EXPECT_EQ(LoadSummaries(store_, RobotId("b"), 1, {1})->size(), 1u);
  EXPECT_EQ(LoadNewestRevisions(store_, RobotId("b"), 1)->size(), 1u);
  EXPECT_TRUE(CountJobs(store_));
  EXPECT_TRUE(LoadWaitingSummaries(store_, 64)->empty());
  EXPECT_EQ(LoadCauseCounts(store_, 20)->size(), 2u);
  EXPECT_TRUE(LoadRobotsToJudge(store_, RobotId("b"), 64)->empty());
  for (const auto& [sql, steps] : Scanned()) ADD_FAILURE() << steps << " rows by: " << sql;
}

TEST_F(QueryPlanTest, TheListOfAllRobotsIsSortedWithoutItsWords) {
  SumUpAll();
  (void)Scanned();
  EXPECT_EQ(CountFleet(store_, {1})->robots, 4);
  for (const char* sort : {"", "robot", "calibrated", "session", "worst", "revision", "sessions", "edges", "model",
                           "site", "due", "operator"})
    for (const bool descending : {false, true})
      EXPECT_EQ(LoadFleetPage(store_, {"", "", sort, descending, 1}, {1})->rows.size(), 4u);
  EXPECT_EQ(LoadFleetPage(store_, {"", "", "", false, 1, "short_session"}, {1})->rows.size(), 4u);
  EXPECT_EQ(LoadFleetPage(store_, {"", "", "", false, 1, "", kStatusWithWork, "", "mars"}, {1})->matches, 0u);
  EXPECT_EQ(LoadChangedStatuses(store_, {1}, 9)->size(), 4u);
  const std::map<std::string, int> scanned = Scanned();
  EXPECT_FALSE(scanned.empty());
  for (const auto& [sql, steps] : scanned) {
    EXPECT_NE(PlanOf(sql).find("COVERING INDEX summary_robot_"), std::string::npos) << sql << ": " << PlanOf(sql);
    const bool by_model = sql.find("GROUP BY rig_model") != std::string::npos;
    EXPECT_TRUE(!by_model || PlanOf(sql).find("TEMP B-TREE") == std::string::npos) << sql << ": " << PlanOf(sql);
    EXPECT_EQ(PlanOf(sql).find("SCAN summary_cause"), std::string::npos) << sql << ": " << PlanOf(sql);
  }
}

// What is replaced when something of a robot changed costs the same in any fleet.
TEST_F(QueryPlanTest, ASummaryIsReplacedWithoutAScan) {
  SumUpAll();
  ASSERT_TRUE(AppendEdge(store_, MakeEdge(7), {1}));
  (void)Scanned();
  SumUpAll();
  std::map<std::string, int> scanned = Scanned();
  std::erase_if(
      scanned, [](const auto& one) { return one.first.find("FROM waiting_summary") != std::string::npos; });  // a queue
  for (const auto& [sql, steps] : scanned) ADD_FAILURE() << steps << " rows by: " << sql;
}

// The test sees a scan where there is one.
TEST_F(QueryPlanTest, AQuestionWithoutAnIndexScans) {
  AppendOpenSession(store_, 3);
  (void)Scanned();
  Query query(store_, "SELECT 1 FROM session WHERE operator_name = ?");
  EXPECT_FALSE(query.Bind(std::string("nobody")).Step());
  EXPECT_FALSE(Scanned().empty());
}

}  // namespace
}  // namespace rigcal::storage
