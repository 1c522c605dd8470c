// Which revision a robot may use, until when, and that every answer and page tells the numbers of one revision.
#include "server/pipeline/robots/validity.h"

#include <nlohmann/json.hpp>

#include "server/pipeline/answers/answer.h"
#include "server/pipeline/robots/robot_state.h"
#include "server/pipeline/sessions/session_refinement.h"
#include "storage/edges/edges.h"
#include "storage/revisions/revisions.h"
#include "storage/sessions/retired.h"
#include "storage/sessions/session_estimates.h"
#include "storage/sessions/standing.h"
#include "storage/work/attempts.h"
#include "tests/unit/pipeline/fixture.h"

namespace rigcal::pipeline {
namespace {

using nlohmann::json;

constexpr const char* kOfRobot = R"({"robot":"r"})";

class ValidityTest : public PipelineTest {
 protected:
  RevisionCache revisions_cache_;
  AnswerContext Context() { return {*store_, clock_, revisions_cache_, clock_.now, ""}; }
  json Ask(const std::string& verb) {
    const auto answer = Answer(Context(), verb, kOfRobot);
    EXPECT_TRUE(answer) << verb << ": " << Sentence(answer.error());
    return json::parse(answer.value_or("{}"));
  }
  json Row() { return Ask("status")["robots"][0]; }
  std::string Page(const std::string& path) {
    const auto page = AnswerPage(Context(), path, "");
    EXPECT_TRUE(page) << path << ": " << Sentence(page.error());
    return page.value_or(PageText{}).body;
  }
  std::string Report(int revision) const {
    std::stringstream page;
    page << std::ifstream(store_->ReportFolder() / "r" / std::to_string(revision) / "index.html").rdbuf();
    return page.str();
  }
  json Event(const std::string& kind) const {
    for (auto event = events_.rbegin(); event != events_.rend(); ++event)
      if (event->first == kind) return json::parse(event->second);
    return nullptr;
  }

  // Three sensors in a loop that closes: usable.
  void PushGood() {
    StoreEdges(Closing("r", 2.0));
    StepAll();
  }
  // One more edge that contradicts them: fails.
  void PushContradiction() {
    std::vector<Edge> edges = {GivenEdge("r", "a", "c", 3.0)};
    AssignPushedIds(edges);
    StoreEdges(edges);
    StepAll();
  }
  static std::vector<Edge> Closing(const std::string& robot, double ac_m) {
    std::vector<Edge> edges = {GivenEdge(robot, "a", "b", 1.0), GivenEdge(robot, "b", "c", 1.0),
                               GivenEdge(robot, "a", "c", ac_m)};
    AssignPushedIds(edges);
    return edges;
  }
};

TEST_F(ValidityTest, OnlyWhatIsUsableGoesOutAndAFailedRevisionNamesIt) {
  PushGood();
  ASSERT_TRUE(IsUsable(revisions_.back().verdict)) << revisions_.back().verdict.why;
  EXPECT_EQ(InUse(), 1);
  EXPECT_EQ(Event("revision")["usable"]["revision"], 1);
  clock_.now.ns += kDay_ns;
  PushContradiction();
  ASSERT_EQ(revisions_.size(), 2U);
  ASSERT_EQ(revisions_.back().verdict.level, VerdictLevel::kFail);
  EXPECT_EQ(InUse(), 1) << "a failed revision is no calibration: what was told before stays";
  const Stamp measured = revisions_[0].calibrated_at.value();
  const json usable = {{"revision", 1},
                       {"created_at", ToIso(revisions_[0].created_at)},
                       {"calibrated_at", ToIso(measured)},
                       {"valid_until", ToIso(Stamp{measured.ns + kDefaultMaxAge_ns})}};
  EXPECT_EQ(Event("revision")["usable"], usable);
  EXPECT_EQ(Ask("show")["usable"], usable);
  EXPECT_EQ(Row()["usable"], usable);
  const std::string keep =
      "Robots that listen still have revision 1, measured " + DayText(measured) + ": do not rely on it";
  for (const std::string& page : {Page("/"), Page("/robots/r/"), Report(2)})
    EXPECT_NE(page.find(keep), std::string::npos) << page;
  EXPECT_EQ(Report(1).find("Robots that listen"), std::string::npos);
}

TEST_F(ValidityTest, WhoBeginsToListenIsToldTheUsableOneAndTheNewestVerdict) {
  PushGood();
  PushContradiction();
  const auto state = LoadRobotState(*store_, RobotId("r"));
  ASSERT_TRUE(state && *state);
  EXPECT_EQ((*state)->newest.number, 2);
  EXPECT_EQ((*state)->newest.verdict.level, VerdictLevel::kFail);
  ASSERT_TRUE((*state)->calibration);
  EXPECT_EQ((*state)->calibration->revision.number, 1);
  EXPECT_EQ((*state)->calibration->poses.size(), 3U);
}

TEST_F(ValidityTest, AFirstRevisionThatFailsHasNothingToFallBackTo) {
  StoreEdges(Closing("r", 3.0));
  StepAll();
  ASSERT_FALSE(IsUsable(revisions_.back().verdict));
  EXPECT_EQ(InUse(), 0);
  EXPECT_TRUE(states_.back().withdrawn.empty()) << "nothing was ever told";
  EXPECT_TRUE(Ask("show")["usable"].is_null());
  const std::string none = "There is no earlier calibration to fall back to.";
  EXPECT_NE(Page("/robots/r/").find(none), std::string::npos);
  EXPECT_NE(Report(1).find(none), std::string::npos);
  EXPECT_EQ(InUse(), 0);
}

// Its poses are those of a rig that is no more: they are taken back, by whichever server tells that.
TEST_F(ValidityTest, WhatWasSolvedBeforeARemountIsNoFallback) {
  PushGood();
  EXPECT_TRUE(states_.back().withdrawn.empty());
  clock_.now.ns += kDay_ns;
  StoreSession("r", {{"left/01.png", "no picture"}, {"right/01.png", "nor this"}}, {SensorId("right")});
  StepAll();
  ASSERT_FALSE(IsUsable(revisions_.back().verdict)) << revisions_.back().verdict.why;
  EXPECT_TRUE(Ask("show")["usable"].is_null());
  EXPECT_EQ(InUse(), 0);
  for (const char* sensor : {"a", "b", "c"})
    EXPECT_EQ(std::count(states_.back().withdrawn.begin(), states_.back().withdrawn.end(), SensorId(sensor)), 1)
        << sensor;
}

// What was said last is told by the order of words: the server's clock was ahead while it solved.
TEST_F(ValidityTest, NorIsItWhereTheClockWasSetBackSince) {
  std::vector<Edge> edges = Closing("r", 2.0);
  const Stamp now = clock_.now;
  for (Edge& edge : edges) edge.measured_at = Stamp{now.ns - kDay_ns};
  AssignPushedIds(edges);
  clock_.now.ns += 3 * kDay_ns;
  StoreEdges(edges);
  StepAll();
  ASSERT_EQ(InUse(), 1);
  clock_.now = now;
  StoreSession("r", {{"left/01.png", "no picture"}, {"right/01.png", "nor this"}}, {SensorId("right")});
  StepAll();
  EXPECT_TRUE(Ask("show")["usable"].is_null());
  EXPECT_EQ(InUse(), 0);
}

// However many sessions came after that one.
TEST_F(ValidityTest, WhatWasSolvedBeforeASensorGaveWayIsNoFallback) {
  PushGood();
  for (int visit = 0; visit < 10; ++visit) {
    clock_.now.ns += kDay_ns;
    const std::string of_visit = " of visit " + std::to_string(visit);
    SessionEstimate estimate;
    estimate.session = StoreSession("r", {{"left/01.png", "none" + of_visit}, {"right/01.png", "nor this" + of_visit}});
    estimate.reference = SensorId("left");
    estimate.moved = {{SensorId("left"), CaptureId("01"), CaptureId("02")}};
    if (visit == 0) {
      const Status kept = storage::AppendSessionEstimate(*store_, estimate, kSessionEstimator, clock_.now);
      ASSERT_TRUE(kept) << Sentence(kept.error());
    }
    StepAll();
    EXPECT_TRUE(Ask("show")["usable"].is_null()) << visit;
  }
}

// What counted in it does no more, so that the newest revision does not even name some of its sensors.
TEST_F(ValidityTest, WhatWasToldOfEdgesThatAreRetiredIsTakenBack) {
  std::vector<Edge> edges = Closing("r", 2.0), more = Closing("r", 2.0);
  more[0].frame_a = SensorId("c"), more[0].frame_b = SensorId("d");
  more.resize(1);
  AssignPushedIds(more);
  StoreEdges(edges);
  StoreEdges(more);
  StepAll();
  ASSERT_EQ(InUse(), 1) << revisions_.back().verdict.why;
  ASSERT_TRUE(storage::RetireEdge(*store_, more[0].id, {clock_.now, "Ada", "of another robot"}));
  for (const Edge& edge : edges) ASSERT_TRUE(storage::RetireEdge(*store_, edge.id, {clock_.now, "Ada", "typed wrong"}));
  StepAll();
  ASSERT_EQ(InUse(), 0) << revisions_.back().verdict.why;
  EXPECT_EQ(states_.back().withdrawn,
            (std::vector<SensorId>{SensorId("a"), SensorId("b"), SensorId("c"), SensorId("d")}));
}

TEST_F(ValidityTest, OverdueIsSaidEverywhereOnceItsTimeHasCome) {
  PushGood();
  const Stamp until{clock_.now.ns + kDefaultMaxAge_ns};
  const std::string report = Report(1);
  EXPECT_NE(report.find("<p class=\"drive until\" dir=\"auto\">OK to drive"), std::string::npos)
      << "for readers without a script";
  EXPECT_NE(report.find(" " + DayText(until) + ".</p>"), std::string::npos);
  EXPECT_NE(report.find("<template data-from=\"" + ToIso(until) +
                        "\"><p class=\"late\">Not verified: do not rely on it, overdue since " + DayText(until)),
            std::string::npos);
  clock_.now = until;
  EXPECT_EQ(Row()["overdue"], false);
  EXPECT_NE(Page("/robots/r/").find("OK to drive"), std::string::npos);
  EXPECT_EQ(Row()["drive"]["until"], ToIso(until));
  clock_.now.ns += 1;
  EXPECT_EQ(Row()["overdue"], true);
  EXPECT_EQ(Ask("show")["overdue"], true);
  EXPECT_EQ(Ask("show")["valid_until"], ToIso(until));
  EXPECT_EQ(json::parse(*Answer(Context(), "lookup", R"({"robot":"r","a":"a","b":"b"})"))["overdue"], true);
  const std::string page = Page("/robots/r/"), fleet = Page("/");
  EXPECT_LT(page.find("overdue since " + DayText(until)), page.find("class=\"word\""));
  EXPECT_NE(page.find("<section class=\"banner " + NameOf(revisions_[0].verdict.level) + " overdue\""),
            std::string::npos);
  EXPECT_EQ(page.find("OK to drive"), std::string::npos);
  EXPECT_EQ(Ask("show")["drive"]["rule"],
            "Not verified: do not rely on it, overdue since " + DayText(until) + "; capture again");
  EXPECT_LT(fleet.find("<span class=\"badge warn\">overdue</span> <span class=\"badge "), fleet.find("class=\"why\""));
}

TEST_F(ValidityTest, AGraphThatWasGivenUpIsToldWithItsCure) {
  PushGood();
  std::vector<Edge> more = {GivenEdge("r", "a", "b", 1.0001), GivenEdge("r", "b", "c", 1.0001)};
  AssignPushedIds(more);
  StoreEdges(more);
  const std::string work =
      storage::WorkOfRevision(RobotId("r"), storage::LoadEdgeWatermark(*store_, RobotId("r")).value(),
                              storage::LoadStandingWatermark(*store_, RobotId("r")).value());
  for (int i = 0; i < 3; ++i) {
    EXPECT_EQ(Row()["calculating"], true);
    ASSERT_TRUE(storage::BeginAttempt(*store_, work, clock_.now));
    EXPECT_EQ(Row()["given_up"], nullptr);  // it is under way
    ASSERT_TRUE(storage::EndAttempt(*store_, work, storage::AttemptEnd::kCutOff, "", clock_.now));
  }
  for (const json& document : {Row(), Ask("show")}) {
    EXPECT_EQ(document["calculating"], false);
    const std::string why = document["given_up"];
    EXPECT_NE(why.find("the server died 3 times while it solved the graph of robot r"), std::string::npos) << why;
    EXPECT_NE(why.find("rigcal retire"), std::string::npos);
  }
  EXPECT_NE(Page("/robots/r/").find("What came last is in no revision"), std::string::npos);
  more = {GivenEdge("r", "a", "b", 1.0002)};
  AssignPushedIds(more);
  StoreEdges(more);
  EXPECT_EQ(Row()["calculating"], true);
  StepAll();
  EXPECT_EQ(Row()["given_up"], nullptr);
}

// What a session that is still being calibrated gave is in no revision yet: nobody tells it.
TEST_F(ValidityTest, AllTellTheNewestRevisionAndThatAnotherIsOnItsWay) {
  PushGood();
  const Stamp first = clock_.now;
  EXPECT_EQ(Row()["calculating"], false);
  EXPECT_EQ(Page("/robots/r/").find("is being calculated"), std::string::npos);
  clock_.now.ns += 40 * kDay_ns;
  std::vector<Edge> more = {GivenEdge("r", "a", "b", 1.0001), GivenEdge("r", "b", "c", 1.0001)};
  AssignPushedIds(more);
  StoreEdges(more);
  const json row = Row(), show = Ask("show");
  EXPECT_EQ(row["edges"], show["document"]["edges"].size());
  for (const json& document : {row, show}) {
    EXPECT_EQ(document["revision"], 1);
    EXPECT_EQ(document["calibrated_at"], ToIso(first));
    EXPECT_EQ(document["calculating"], true);
  }
  EXPECT_EQ(Ask("due")["robots"][0]["calibrated_at"], ToIso(first));
  const std::string page = Page("/robots/r/");
  EXPECT_NE(page.find("Calibrated 40 days ago, 0 sessions, 3 edges"), std::string::npos) << page;
  EXPECT_NE(page.find("A newer revision is being calculated. This page still tells revision 1."), std::string::npos);
  StepAll();
  EXPECT_EQ(Row()["calculating"], false);
  EXPECT_EQ(Row()["edges"], 5);
  EXPECT_EQ(Row()["calibrated_at"], ToIso(clock_.now));
  // The history ends with the date that the page tells.
  EXPECT_NE(Page("/robots/r/trend.js").find("\"date\":\"" + ToIso(clock_.now).substr(0, 10) + "\""), std::string::npos);
}

TEST_F(ValidityTest, TheAgeOfPushedEdgesIsThatOfTheirMeasurement) {
  std::vector<Edge> edges = Closing("r", 2.0);
  const Stamp measured{clock_.now.ns - 100 * kDay_ns};
  for (Edge& edge : edges) edge.measured_at = measured;
  edges[1].measured_at = Stamp{measured.ns - kDay_ns};  // the other two tie all three
  AssignPushedIds(edges);
  StoreEdges(edges);
  StepAll();
  EXPECT_EQ(Ask("show")["calibrated_at"], ToIso(measured));
  EXPECT_EQ(Ask("show")["valid_until"], ToIso({measured.ns + kDefaultMaxAge_ns}));
  EXPECT_EQ(Row()["overdue"], true);
  EXPECT_EQ(Row()["age_ns"], 100 * kDay_ns);
  EXPECT_EQ(json::parse(*Answer(Context(), "due", "{}"))["robots"][0]["overdue"], true);
  edges[0].measured_at.reset();  // of now
  AssignPushedIds(edges);
  StoreEdges({edges[0]});
  StepAll();
  EXPECT_EQ(Row()["overdue"], true) << "two of three sensors";
  edges[2].measured_at.reset();
  AssignPushedIds(edges);
  StoreEdges({edges[2]});
  StepAll();
  EXPECT_EQ(Row()["overdue"], false);
}

// One that was measured before its sensor was moved is past, however late it comes.
TEST_F(ValidityTest, AnEdgeOfBeforeARemountIsPastIfItTellsWhenItWasMeasured) {
  StoreSession("r", {{"left/01.png", "1"}, {"right/01.png", "2"}}, {SensorId("right")});
  std::vector<Edge> edges = {GivenEdge("r", "left", "right", 0.1), GivenEdge("r", "left", "right", 0.2),
                             GivenEdge("r", "left", "right", 0.3)};
  edges[0].measured_at = Stamp{clock_.now.ns - kDay_ns};
  edges[1].measured_at = Stamp{clock_.now.ns + kDay_ns / 2};
  AssignPushedIds(edges);
  StoreEdges(edges);
  StepAll();
  for (const json& row : Ask("edges")["edges"]) {
    if (row["method"] != "given") continue;
    EXPECT_EQ(row["state"] == "failed", row["id"] == edges[0].id.str());
    if (row["state"] == "failed") {
      EXPECT_EQ(row["diagnoses"][0]["code"], "remounted");
    }
  }
}

// A session of a wrong date that was pushed again in a corrected form does not keep the robot from being due.
TEST_F(ValidityTest, WhatNoLongerCountsDoesNotDateTheCalibration) {
  const auto give = [&](const SessionId& session) {
    Edge edge = GivenEdge("r", "left", "right", 0.1);
    edge.session = session;
    edge.id = EstimatedEdgeId(edge.robot, edge.session, edge.method, edge.frame_a, edge.frame_b);
    StoreEdges({edge});
  };
  const std::map<std::string, std::string> files = {{"left/01.png", "1"}, {"right/01.png", "2"}};
  const Stamp right = clock_.now;
  clock_.now.ns += 300 * kDay_ns;  // a year mistyped
  give(StoreSession("r", files));
  clock_.now = right;
  give(StoreSession("r", files));
  StepAll();
  EXPECT_EQ(Ask("show")["calibrated_at"], ToIso(right));
}

}  // namespace
}  // namespace rigcal::pipeline
