// Lists of robots say what the store says of each, soon after it changed, and whatever else the store is doing.

#include "server/pipeline/robots/summaries.h"

#include <SQLiteCpp/SQLiteCpp.h>
#include <gmock/gmock.h>

#include <future>
#include <mutex>
#include <nlohmann/json.hpp>
#include <thread>

#include "server/pipeline/answers/answer.h"
#include "server/pipeline/sessions/session_refinement.h"
#include "storage/fleet/fleet_facts.h"
#include "storage/fleet/robot_summary.h"
#include "storage/revisions/decisions.h"
#include "storage/revisions/revisions.h"
#include "storage/sessions/retired.h"
#include "storage/work/attempts.h"
#include "tests/unit/pipeline/fixture.h"

namespace rigcal::pipeline {
namespace {

using nlohmann::json;
using testing::HasSubstr;
using testing::Not;

class SummariesTest : public PipelineTest {
 protected:
  RevisionCache revisions_cache_;
  AnswerContext Context() { return {*store_, clock_, revisions_cache_, clock_.now, ""}; }
  json Ask(const std::string& verb, const std::string& parameters = "{}") {
    const auto answer = Answer(Context(), verb, parameters);
    EXPECT_TRUE(answer) << verb << ": " << Sentence(answer.error());
    return json::parse(answer.value_or("{}"));
  }
  std::string Fleet(const std::string& query = "") {
    const auto page = AnswerPage(Context(), "/", query);
    EXPECT_TRUE(page) << Sentence(page.error());
    return page.value_or(PageText{}).body;
  }
  std::size_t Waiting() { return storage::LoadWaitingSummaries(*store_, 100'000).value().size(); }
  std::vector<RobotSummary> Stored() {
    return storage::LoadSummaries(*store_, RobotId(), std::nullopt, clock_.now).value();
  }
  void AppendRobots(int count) {
    ASSERT_TRUE(store_->Write([&]() -> Status {
      for (int i = 0; i < count; ++i)
        RIGCAL_TRY(storage::AppendRobot(*store_, RobotId("robot-" + std::to_string(10'000 + i)), clock_.now));
      return {};
    }));
  }
  static std::vector<Edge> Pushed(const std::string& a, const std::string& b, double x_m) {
    std::vector<Edge> edges = {GivenEdge("r", a, b, x_m)};
    AssignPushedIds(edges);
    return edges;
  }
  // A list says what is worked out of the one robot.
  void ExpectSame(const std::string& when) {
    const json listed = Ask("robots")["robots"];
    json of_robot = Ask("status", R"({"robot":"r"})")["robots"];
    for (json& row : of_robot) row.erase("sensors");  // only of one that is asked for
    EXPECT_EQ(listed, of_robot) << when;
    const auto summary = LoadRobotSummary(*store_, RobotId("r"), clock_.now);
    ASSERT_TRUE(summary && Stored().size() == 1) << when;
    EXPECT_EQ(Stored().front().last_session_at, summary->last_session_at) << when;
    EXPECT_EQ(Stored().front().worst.has_value(), summary->worst.has_value()) << when;
    EXPECT_EQ(Stored().front().calibrations.size(), summary->calibrations.size()) << when;
  }
};

TEST_F(SummariesTest, ListsSayWhatTheStoreSaysWhateverCame) {
  const std::vector<Edge> edges = Triangle("r");
  const BatchId batch = BatchIdOf(RobotId("r"), edges);
  for (std::int64_t item = 0; item < 3; ++item) {
    ASSERT_TRUE(store_->Write([&]() -> Status {
      RIGCAL_TRY(storage::AppendBatch(*store_, RobotId("r"), batch, 3, clock_.now));
      return storage::AppendBatchItems(*store_, batch, {{item, edges[static_cast<std::size_t>(item)]}}, clock_.now);
    }));
    clock_.now.ns += 1'000'000'000;
    ExpectSame("item " + std::to_string(item));
  }
  StepAll();
  ExpectSame("revised");
  StoreEdges(Pushed("a", "c", 3.0));
  ExpectSame("an edge that contradicts the others");
  StepAll();
  ExpectSame("revised again");
  ASSERT_TRUE(storage::RetireEdge(*store_, edges[0].id, {clock_.now, "Ada", "typed wrong"}));
  ExpectSame("an edge is retired");
  StepAll();
  ExpectSame("revised without it");
  StoreSession("r", {{"left/01.png", "no picture"}, {"right/01.png", "nor this"}}, {SensorId("right")});
  ExpectSame("a session with a job, of a sensor that was remounted");
  StepAll();
  ExpectSame("its job is done");
  clock_.now.ns += 91LL * 24 * 3600 * 1'000'000'000;
  ExpectSame("overdue");
}

TEST_F(SummariesTest, ListsSayThatAGraphWasGivenUp) {
  StoreEdges(Triangle("r"));
  const std::string work =
      storage::WorkOfRevision(RobotId("r"), storage::LoadEdgeWatermark(*store_, RobotId("r")).value(), 0);
  for (int i = 0; i < 3; ++i) {
    ASSERT_TRUE(storage::BeginAttempt(*store_, work, clock_.now));
    ASSERT_TRUE(storage::EndAttempt(*store_, work, storage::AttemptEnd::kCutOff, "", clock_.now));
    ExpectSame("attempt " + std::to_string(i + 1));
  }
  EXPECT_THAT(Fleet(), HasSubstr("the server died 3 times while it solved the graph of robot r"));
  StoreEdges(Pushed("a", "c", 2.0));
  ExpectSame("another edge");
}

TEST_F(SummariesTest, WhoHearsOfARevisionFindsItInTheLists) {
  int listed = 0;
  announcer_.event = [&](const RobotId&, const std::string& kind, const std::string&, const std::string&) {
    if (kind == "revision") listed = Stored().front().revision;
  };
  StoreEdges(Triangle("r"));
  StepAll();
  EXPECT_EQ(listed, 1);
  EXPECT_EQ(Waiting(), 0u);
}

TEST_F(SummariesTest, AStepTakesUpSomeAndGoesOnWhileThereAreMore) {
  AppendRobots(150);
  EXPECT_EQ(Waiting(), 150u);
  EXPECT_EQ(StepAll(), 2);
  EXPECT_EQ(Waiting(), 0u);
  EXPECT_EQ(Stored().size(), 150u);
  EXPECT_EQ(StepAll(), 0);
}

TEST_F(SummariesTest, AnotherThreadIsNotInTheWay) {
  AppendRobots(1);
  SummaryTurn turn;
  StepContext context{*store_, clock_, live_, claims_, announcer_, cameras_};
  context.summaries = &turn;
  std::promise<void> taken, end;
  std::thread other([&] {
    const std::lock_guard works(turn.taken);
    taken.set_value();
    end.get_future().wait();
  });
  taken.get_future().wait();
  const auto beside = Step(context);
  end.set_value();
  other.join();
  ASSERT_TRUE(beside);
  EXPECT_FALSE(beside->worked);
  EXPECT_EQ(Waiting(), 1u);
  EXPECT_TRUE(Step(context));
  EXPECT_EQ(Waiting(), 0u);
}

TEST_F(SummariesTest, AtTheStartAllAreWorkedOut) {
  AppendRobots(2500);
  RefreshAllSummaries(*store_, clock_);
  EXPECT_EQ(Waiting(), 0u);
  EXPECT_EQ(Stored().size(), 2500u);
}

TEST_F(SummariesTest, AListIsReadWhileAnotherHasTheStore) {
  StoreEdges(Triangle("r"));
  EXPECT_THAT(Fleet(), HasSubstr("The first result is being worked out."));
  StoreEdges(Triangle("s"));
  auto other = storage::Store::Open(folder_);
  ASSERT_TRUE(other);
  EXPECT_TRUE(other->Write([&]() -> Status {
    EXPECT_THAT(Fleet(), HasSubstr(">r</a>"));
    EXPECT_EQ(Ask("robots")["robots"].size(), 2u);  // what could not be kept is told all the same
    EXPECT_EQ(Ask("due")["robots"].size(), 2u);
    EXPECT_EQ(Ask("status")["robots"].size(), 2u);
    return {};
  }));
  EXPECT_THAT(Fleet(), HasSubstr(">s</a>"));
}

TEST_F(SummariesTest, OneRobotThatCannotBeReadKeepsNoOtherWaiting) {
  Manifest manifest;
  manifest.header.robot = RobotId("broken");
  manifest.header.captured_at = clock_.now;
  const SessionId session = Close(manifest);
  Revision revision;
  revision.robot = RobotId("broken");
  revision.digest = Sha256Of("{}");
  revision.document = "{}";
  ASSERT_TRUE(store_->Write([&]() -> Status {
    for (const VerdictLevel level : {VerdictLevel::kPass, VerdictLevel::kFail}) {
      revision.verdict.level = level;
      RIGCAL_TRY(storage::AppendRevision(*store_, revision));
    }
    RIGCAL_TRY(
        storage::AppendDecision(*store_, revision.robot, 1, storage::Deciding::kApprove, {clock_.now, "Ada", ""}));
    return storage::AppendRobot(*store_, RobotId("well"), clock_.now);
  }));
  store_->database().exec("INSERT INTO session_estimate SELECT number, '" + std::string(kSessionEstimator) +
                          "', 1, 'no document' FROM session WHERE session_id = '" + session.str() + "'");
  const json robots = Ask("robots")["robots"];
  ASSERT_EQ(robots.size(), 2u);
  EXPECT_EQ(robots[0]["verdict"]["level"], "unknown");
  EXPECT_THAT(robots[0]["verdict"]["why"].get<std::string>(), HasSubstr("What is stored of it cannot be read: "));
  EXPECT_EQ(robots[1]["verdict"]["why"], "There is no revision yet.");
  EXPECT_EQ(Waiting(), 0u);
}

// Of robots whose page of the database is damaged, say: nothing is known of them then, and all of that is logged once.
TEST_F(SummariesTest, RobotsThatAFaultKeepsFromBeingSummedUpKeepNoOtherWaiting) {
  constexpr int kBroken = 70;  // more than are taken up at once
  Revision revision;
  revision.digest = Sha256Of("{}");
  revision.document = "{}";
  ASSERT_TRUE(store_->Write([&]() -> Status {
    for (int i = 0; i < kBroken; ++i) {
      revision.robot = RobotId("broken-" + std::to_string(10 + i));
      RIGCAL_TRY(storage::AppendRevision(*store_, revision));
      RIGCAL_TRY(storage::AppendWorstEdge(*store_, {revision.robot, 1}, {SensorId("a"), SensorId("b"), 1.5}));
    }
    return storage::AppendRobot(*store_, RobotId("well"), clock_.now);
  }));
  store_->database().exec(
      "ALTER TABLE revision_worst_edge RENAME TO readable_worst_edge; CREATE VIEW revision_worst_edge AS "
      "SELECT robot_id, revision_number, frame_a, frame_b, abs(revision_number - 9223372036854775807 - 2) AS "
      "residual_ratio "
      "FROM readable_worst_edge");
  ASSERT_EQ(LoadRobotSummary(*store_, RobotId("broken-10"), clock_.now).error().code, ErrorCode::kStorage);
  SummaryTurn turn;
  const auto first = RefreshSummaries(*store_, clock_, 64, turn);
  ASSERT_TRUE(first) << Sentence(first.error());
  EXPECT_EQ(first->made, 0);
  EXPECT_FALSE(first->more) << "or it would never come to rest";
  const auto second = RefreshSummaries(*store_, clock_, 64, turn);
  ASSERT_TRUE(second) << Sentence(second.error());
  EXPECT_EQ(second->made, 1);
  ASSERT_EQ(Stored().size(), 1u);
  EXPECT_EQ(Stored().front().robot, RobotId("well"));
  EXPECT_EQ(turn.unmade.size(), std::size_t{kBroken});
  EXPECT_EQ(Waiting(), std::size_t{kBroken});
  store_->database().exec(
      "DROP VIEW revision_worst_edge; ALTER TABLE readable_worst_edge RENAME TO revision_worst_edge");
  for (int i = 0; i < 2; ++i) EXPECT_TRUE(RefreshSummaries(*store_, clock_, 64, turn));
  EXPECT_EQ(Waiting(), 0u);
  EXPECT_TRUE(turn.unmade.empty());
}

TEST_F(SummariesTest, ListsAreAskedForInParts) {
  AppendRobots(5);
  const auto names = [](const json& document) {
    std::string text;
    for (const json& row : document["robots"]) text += row["robot"].get<std::string>().substr(10);
    return text;
  };
  for (const std::string verb : {"robots", "status", "due"}) {
    const json all = Ask(verb), first = Ask(verb, R"({"limit":2})");
    EXPECT_EQ(names(all), "01234") << verb;
    EXPECT_FALSE(all.contains("next")) << verb;
    EXPECT_EQ(names(first), "01") << verb;
    EXPECT_EQ(first["next"], "robot-10001") << verb;
    const json last = Ask(verb, R"({"limit":3,"after":"robot-10001"})");
    EXPECT_EQ(names(last), "234") << verb;
    EXPECT_TRUE(last.contains("next") && last["next"].is_null()) << verb;
    EXPECT_EQ(names(Ask(verb, R"({"after":"robot-10002x"})")), "34") << verb;
    EXPECT_EQ(names(Ask(verb, R"({"limit":"9","after":"robot-10004"})")), "") << verb;
    for (const char* wrong :
         {R"({"limit":0})", R"({"limit":-1})", R"({"limit":"x"})", R"({"after":"../x"})", R"({"after":""})"})
      EXPECT_EQ(Answer(Context(), verb, wrong).error().code, ErrorCode::kInvalidInput) << verb << wrong;
  }
  StoreSession("robot-10003", {{"left/01.png", "no picture"}, {"right/01.png", "nor this"}});
  EXPECT_EQ(Ask("status", R"({"limit":1})")["jobs_waiting"], 1) << "of all robots";
}

TEST_F(SummariesTest, AListOfASiteHasTheRobotsThere) {
  for (const auto& [robot, site] : std::map<std::string, std::string>{
           {"a", "hall 3"}, {"b", "harbour"}, {"c", "hall 3"}, {"d", "harbour"}, {"e", "hall 3"}}) {
    Manifest manifest;
    manifest.header.robot = RobotId(robot);
    manifest.header.reference = SensorId("left");
    manifest.header.captured_at = clock_.now;
    manifest.header.conditions = {{"site", site}};
    manifest.header.targets.emplace_back().id = TargetId("board");
    manifest.header.targets[0].cols = 9, manifest.header.targets[0].rows = 6,
    manifest.header.targets[0].square_m = 0.025;
    for (const char* name : {"left", "right"}) {
      manifest.header.sensors.emplace_back().id = SensorId(name);
      AddFile(std::string(name) + "/01.png", std::string("no picture of ") + name, manifest);
    }
    Close(manifest);
  }
  AppendRobots(1);
  StepAll();
  const auto names = [](const json& document) {
    std::string text;
    for (const json& row : document["robots"]) text += row["robot"].get<std::string>();
    return text;
  };
  for (const std::string verb : {"robots", "status", "due"}) {
    EXPECT_EQ(names(Ask(verb, R"({"site":"hall 3"})")), "ace") << verb;
    const json first = Ask(verb, R"({"site":"hall 3","limit":2})");
    EXPECT_EQ(names(first), "ac") << verb;
    EXPECT_EQ(first["next"], "c") << verb;
    const json last = Ask(verb, R"({"site":"hall 3","limit":2,"after":"c"})");
    EXPECT_EQ(names(last), "e") << verb;
    EXPECT_TRUE(last["next"].is_null()) << verb;
    EXPECT_EQ(Ask(verb, R"({"site":""})")["robots"].size(), 6U) << verb;
  }
  for (const std::string verb : {"robots", "status", "due", "due_ics"}) {
    const auto unknown = Answer(Context(), verb, R"({"site":"hal 3"})");
    ASSERT_FALSE(unknown) << verb;
    EXPECT_EQ(unknown.error().code, ErrorCode::kNotFound) << verb;
    EXPECT_THAT(unknown.error().what, HasSubstr("did you mean hall 3?")) << verb;
  }
}

TEST_F(SummariesTest, WhatOpenPagesAskCountsTheWholeFleet) {
  StoreEdges(Triangle("r"));
  StoreSession("s", {{"left/01.png", "no picture"}, {"right/01.png", "nor this"}});
  const json live = Ask("live");
  EXPECT_TRUE(live["robot"].is_null());
  EXPECT_EQ(live["robots"], 2);
  EXPECT_EQ(live["sessions"], 1);
  EXPECT_EQ(live["edges"], 3);
  EXPECT_EQ(live["unfinished"], 2);  // r is to be solved, a pair of s to be calibrated
  EXPECT_TRUE(live["revision"].is_null());
  const json of_robot = Ask("live", R"({"robot":"r"})");
  EXPECT_EQ(of_robot["robots"], 1);
  EXPECT_EQ(of_robot["sessions"], 0);
  EXPECT_EQ(of_robot["edges"], 3);
  StepAll();
  EXPECT_EQ(Ask("live")["unfinished"], 0);
  EXPECT_EQ(Ask("live")["edges"], 4);
}

TEST_F(SummariesTest, ListsNameRigModelAndOperatorWhereASessionDoes) {
  StoreEdges(Triangle("r"));
  StepAll();
  ASSERT_EQ(Stored().front().calibrations.size(), 1u);
  EXPECT_EQ(ToIso(Stored().front().calibrations[0].calibrated_at), ToIso(*Stored().front().validity.calibrated_at));
  for (const char* key : {"rig_model", "operator", "site"})
    EXPECT_TRUE(Ask("robots")["robots"][0].at(key).is_null()) << key;
  Manifest manifest;
  manifest.header.robot = RobotId("r");
  manifest.header.captured_at = clock_.now;
  manifest.header.rig_model = "mars-mapper";
  manifest.header.operator_name = "Ada";
  Close(manifest);
  EXPECT_EQ(Ask("robots")["robots"][0]["rig_model"], "mars-mapper");
  EXPECT_EQ(Ask("robots")["robots"][0]["operator"], "Ada");
  EXPECT_THAT(Fleet("q=mars+ada"), HasSubstr("by <bdi>Ada</bdi>"));
  EXPECT_THAT(Fleet("model=mars-mapper"), HasSubstr("Rig model mars-mapper"));
  EXPECT_THAT(Fleet("model=mars"), HasSubstr("No robot is like that."));
  manifest.header.captured_at.ns += 1;
  manifest.header.rig_model = manifest.header.operator_name = "";
  Close(manifest);
  EXPECT_EQ(Ask("robots")["robots"][0]["rig_model"], "mars-mapper") << "no later one says otherwise";
  EXPECT_TRUE(Ask("robots")["robots"][0]["operator"].is_null()) << "nobody knows who was there";
  ExpectSame("a session that names nobody");
}

TEST_F(SummariesTest, MetricsCountTheWholeFleet) {
  StoreEdges(Triangle("r"));
  StepAll();
  AppendRobots(2);
  const std::string metrics = AnswerPage(Context(), "/metrics", "")->body;
  EXPECT_THAT(metrics, HasSubstr("rigcal_edges 3\n"));
  EXPECT_THAT(metrics, HasSubstr("rigcal_jobs_waiting 0\n"));
  EXPECT_THAT(metrics, HasSubstr("rigcal_robots{verdict=\"unknown\"} 2\n"));
  EXPECT_THAT(metrics, Not(HasSubstr("rigcal_robots{verdict=\"overdue\"}")));
  EXPECT_THAT(Fleet("verdict=unknown"), HasSubstr("2 of 3 robots"));
}

}  // namespace
}  // namespace rigcal::pipeline
