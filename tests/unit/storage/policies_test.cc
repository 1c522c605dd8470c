// Versions of the limits that people set, whom each makes wait to be judged anew, and until when.
#include "storage/settings/policies.h"

#include <gmock/gmock.h>

#include "server/formats/documents.h"
#include "storage/fleet/fleet_list.h"
#include "storage/fleet/robot_summary.h"
#include "tests/unit/storage/fixture.h"
#include "tests/unit/storage/old_store.h"

namespace rigcal::storage {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

const PolicyPlace kFleet{PolicyScope::kFleet, ""}, kModel{PolicyScope::kModel, "stereo-rig"},
    kOfRobot{PolicyScope::kRobot, kRobot.str()};

class PoliciesTest : public StoreTest {
 protected:
  PolicyVersion Set(const PolicyPlace& place, const std::string& text) {
    const auto set = AppendPolicy(store_, place, text, {{++now_}, "Ada", "new mounts"});
    EXPECT_TRUE(set) << WordsOf(set);
    return set.value_or(PolicyVersion{});
  }
  // A robot with an edge in a revision that counts every policy.
  void AppendJudged(const RobotId& robot) {
    ASSERT_TRUE(AppendRobot(store_, robot, {1}));
    ASSERT_TRUE(AppendEdge(store_, MakeEdge(1, robot), {1}));
    Judge(robot);
  }
  void Judge(const RobotId& robot) {
    Revision revision = MakeRevision(LoadEdgeWatermark(store_, robot).value(), robot);
    revision.policy_watermark = LoadPolicyWatermark(store_).value();
    ASSERT_TRUE(AppendRevision(store_, revision));
  }
  std::vector<std::string> Waiting() {
    std::vector<std::string> names;
    const std::vector<RobotId> robots = LoadRobotsToJudge(store_, RobotId(), 100).value();
    for (const RobotId& robot : robots) names.push_back(robot.str());
    return names;
  }
  std::vector<std::string> Urgent() {
    std::vector<std::string> names;
    const std::vector<RobotId> robots = LoadUnsolvedRobots(store_).value();
    for (const RobotId& robot : robots) names.push_back(robot.str());
    return names;
  }
  // A closed session that names its rig model.
  void CloseSessionOf(const RobotId& robot, const std::string& model, std::size_t payloads, std::int64_t captured_ns) {
    Manifest manifest = MakeManifest(payloads, robot);
    manifest.header.rig_model = model;
    manifest.header.captured_at = {captured_ns};
    const SessionId id = IdOf(manifest);
    std::vector<std::uint32_t> all(payloads);
    for (std::uint32_t i = 0; i < payloads; ++i) all[i] = i;
    ASSERT_TRUE(AppendSession(store_, id, formats::WriteManifest(manifest), manifest, {10}));
    ASSERT_TRUE(AppendHeld(store_, id, all, {11}));
    ASSERT_TRUE(CloseSession(store_, id, {}, {12}));
  }

  std::int64_t now_ = 0;
};

TEST_F(PoliciesTest, OfEachPlaceTheNewestHoldsAndAllAreKept) {
  EXPECT_FALSE(LoadPolicy(store_, kFleet)->has_value());
  EXPECT_EQ(LoadPolicyWatermark(store_).value(), 0);
  Set(kFleet, "tolerance_mm: 4\n");
  Set(kOfRobot, "tolerance_mm: 3\n");
  const PolicyVersion second = Set(kFleet, "tolerance_mm: 5\n");
  EXPECT_EQ(second.version, 2);
  const auto newest = LoadPolicy(store_, kFleet).value();
  ASSERT_TRUE(newest);
  EXPECT_EQ(newest->text, "tolerance_mm: 5\n");
  EXPECT_EQ(newest->place, kFleet);
  EXPECT_EQ(newest->version, 2);
  EXPECT_EQ(newest->word.who, "Ada");
  EXPECT_EQ(newest->word.reason, "new mounts");
  EXPECT_EQ(newest->word.at, Stamp{3});
  EXPECT_EQ(LoadPolicyWatermark(store_).value(), newest->number);
  EXPECT_EQ(LoadPolicy(store_, kOfRobot).value()->version, 1);
  EXPECT_EQ(IntIn(store_, "SELECT count(*) FROM policy"), 3);
  EXPECT_EQ(TextIn(store_, "SELECT what FROM audit ORDER BY number DESC LIMIT 1"),
            "set version 2 of the policy of the fleet: new mounts");
}

TEST_F(PoliciesTest, TheSameTextOnceMoreIsNoOtherVersion) {
  const PolicyVersion first = Set(kFleet, "tolerance_mm: 4\n"), again = Set(kFleet, "tolerance_mm: 4\n");
  EXPECT_EQ(again.number, first.number);
  EXPECT_EQ(again.word.at, first.word.at);
  EXPECT_EQ(IntIn(store_, "SELECT count(*) FROM policy"), 1);
}

TEST_F(PoliciesTest, AWordIsOneReadableLine) {
  EXPECT_EQ(AppendPolicy(store_, kFleet, "", {{1}, "Ada", "two\nlines"}).error().code, ErrorCode::kInvalidInput);
  EXPECT_EQ(LoadPolicyWatermark(store_).value(), 0);
}

TEST_F(PoliciesTest, OneOfTheFleetLetsAllRobotsWithEdgesWaitUntilTheyAreJudged) {
  AppendJudged(RobotId("a"));
  AppendJudged(RobotId("b"));
  ASSERT_TRUE(AppendRobot(store_, RobotId("without-edges"), {1}));
  EXPECT_THAT(Waiting(), IsEmpty());
  const PolicyVersion set = Set(kFleet, "tolerance_mm: 4\n");
  EXPECT_THAT(Waiting(), ElementsAre("a", "b"));
  EXPECT_EQ(CountRobotsToJudge(store_, set.number).value(), 2);
  EXPECT_THAT(Urgent(), IsEmpty()) << "nobody waits for one of them";
  EXPECT_TRUE(IsUnsolved(store_, RobotId("a")).value());
  EXPECT_EQ(LoadFleetSize(store_)->unfinished, 2 + 2) << "to judge, and to publish";
  EXPECT_EQ(LoadRobotsToJudge(store_, RobotId("a"), 1)->front(), RobotId("b"));
  Judge(RobotId("a"));
  EXPECT_THAT(Waiting(), ElementsAre("b"));
  EXPECT_FALSE(IsUnsolved(store_, RobotId("a")).value());
}

TEST_F(PoliciesTest, OneOfARobotIsUrgentAndTouchesNoOther) {
  AppendJudged(kRobot);
  AppendJudged(RobotId("b"));
  Set(kOfRobot, "tolerance_mm: 4\n");
  EXPECT_THAT(Urgent(), ElementsAre(kRobot.str()));
  EXPECT_THAT(Waiting(), ElementsAre(kRobot.str()));
  Set(kFleet, "tolerance_mm: 4\n");
  EXPECT_THAT(Urgent(), ElementsAre(kRobot.str())) << "it still is";
}

// A revision that was begun before a policy was set does not count it.
TEST_F(PoliciesTest, ARevisionOfAnOlderPolicyLeavesTheRobotWaiting) {
  AppendJudged(kRobot);
  const std::int64_t before = LoadPolicyWatermark(store_).value();
  Set(kOfRobot, "tolerance_mm: 4\n");
  Revision revision = MakeRevision(LoadEdgeWatermark(store_, kRobot).value());
  revision.policy_watermark = before;
  ASSERT_TRUE(AppendRevision(store_, revision));
  EXPECT_THAT(Waiting(), ElementsAre(kRobot.str()));
}

TEST_F(PoliciesTest, OneOfARigModelIsForRobotsThatNamedIt) {
  AppendJudged(RobotId("a"));
  AppendJudged(RobotId("b"));
  EXPECT_EQ(LoadRigModel(store_, RobotId("a")).value(), "");
  CloseSessionOf(RobotId("a"), "old-rig", 1, 10);
  CloseSessionOf(RobotId("a"), "stereo-rig", 2, 30);
  CloseSessionOf(RobotId("a"), "older-rig", 3, 5);  // late
  CloseSessionOf(RobotId("b"), "other", 4, 10);
  EXPECT_THAT(LoadRigModels(store_, 9).value(), ElementsAre("old-rig", "older-rig", "other", "stereo-rig"));
  EXPECT_THAT(LoadRigModels(store_, 2).value(), ElementsAre("old-rig", "older-rig"));
  EXPECT_TRUE(HasRigModel(store_, "older-rig").value());
  EXPECT_FALSE(HasRigModel(store_, "old").value());
  EXPECT_EQ(LoadRigModel(store_, RobotId("a")).value(), "stereo-rig");
  for (const char* robot : {"a", "b"}) Judge(RobotId(robot));
  Set(kModel, "tolerance_mm: 4\n");
  EXPECT_THAT(Waiting(), ElementsAre("a"));
}

TEST_F(PoliciesTest, ARevisionKeepsHowItWasJudged) {
  ASSERT_TRUE(AppendRobot(store_, kRobot, {1}));
  Revision revision = MakeRevision(0);
  revision.policy_watermark = 7, revision.max_age_ns = 11;
  revision.verdict.unverified = "left and right";
  ASSERT_TRUE(AppendRevision(store_, revision));
  const auto expect = [](const Revision& loaded) {
    EXPECT_EQ(loaded.policy_watermark, 7);
    EXPECT_EQ(loaded.max_age_ns, 11);
    EXPECT_EQ(loaded.verdict.unverified, "left and right");
  };
  expect(*LoadRevision(store_, kRobot, 1).value());
  expect(*LoadRevisionSummary(store_, kRobot, 0).value());
  expect(LoadRevisions(store_, kRobot)->front());
}

TEST_F(PoliciesTest, ASummaryIsOverdueByTheAgeOfItsPolicy) {
  ASSERT_TRUE(AppendRobot(store_, kRobot, {1}));
  RobotSummary summary;
  summary.robot = kRobot, summary.revision = 1;
  summary.verdict = {VerdictLevel::kUnknown, "why", "what", "left"};
  summary.validity.calibrated_at = Stamp{100};
  summary.validity.max_age_ns = 50;
  ASSERT_TRUE(ReplaceSummary(store_, summary, 1));
  const auto loaded = LoadSummaries(store_, RobotId(), std::nullopt, {150})->front();
  EXPECT_EQ(loaded.validity.max_age_ns, 50);
  EXPECT_EQ(loaded.verdict.unverified, "left");
  EXPECT_FALSE(loaded.validity.overdue);
  EXPECT_EQ(CountFleet(store_, {150})->overdue, 0);
  EXPECT_TRUE(LoadSummaries(store_, RobotId(), std::nullopt, {151})->front().validity.overdue);
  EXPECT_EQ(CountFleet(store_, {151})->overdue, 1);
}

// Version 17: no policies; its sessions say their rig model in their manifests.
TEST(PoliciesMigration, RevisionsAndSessionsOfVersion17) {
  const TempFolder folder;
  std::string sql = EmptyStoreOfVersion(17);
  sql +=
      "INSERT INTO robot VALUES ('r', 1);"
      "INSERT INTO session VALUES (1, 's1', 'r', 10, 1, '', 0, 5, '{\"rig_model\":\"mars\"}');"
      "INSERT INTO session VALUES (2, 's2', 'r', 20, 1, '', 0, 5, '{\"rig_model\":\"\"}');"
      "INSERT INTO session VALUES (3, 's3', 'r', 30, 1, '', 0, 5, '{\"rig_model\":\"open\"}');"
      "INSERT INTO session_closed VALUES (1, 2), (2, 3);"
      "INSERT INTO revision VALUES ('r', 1, 5, 0, 'pass', 'why', 'do', '" +
      std::string(64, 'a') +
      "', '{}');"
      "INSERT INTO summary_robot (robot_id, changes, name_key, revision_number, verdict, sessions, edges, "
      "jobs_waiting, search, "
      "calculating, worst_frame_a, worst_frame_b, verdict_why, verdict_what_to_do, given_up, calibrated_ns) "
      "VALUES ('r', 1, 'r', 1, 'pass', 1, 1, 0, '', 0, '', '', 'why', 'do', '', 100);";
  MakeDatabase(folder.path(), sql);
  Result<Store> store = Store::Open(folder.path());
  ASSERT_TRUE(store) << WordsOf(store);
  EXPECT_EQ(LoadRigModel(*store, RobotId("r")).value(), "mars");
  const Revision revision = *LoadRevision(*store, RobotId("r"), 1).value();
  EXPECT_EQ(revision.max_age_ns, kDefaultMaxAge_ns);
  EXPECT_EQ(revision.policy_watermark, 0);
  EXPECT_EQ(LoadSummaries(*store, RobotId(), std::nullopt, {1})->front().validity.max_age_ns, kDefaultMaxAge_ns);
  EXPECT_TRUE(LoadRobotsToJudge(*store, RobotId(), 9)->empty());
}

}  // namespace
}  // namespace rigcal::storage
