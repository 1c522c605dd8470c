// What a session found of the calibration in use, from its estimate to what is told of it.
#include "storage/revisions/as_found.h"

#include <gmock/gmock.h>

#include <nlohmann/json.hpp>

#include "server/pipeline/answers/answer.h"
#include "server/pipeline/orders/orders.h"
#include "server/pipeline/revisions/revise.h"
#include "server/pipeline/sessions/session_refinement.h"
#include "storage/revisions/decisions.h"
#include "storage/sessions/session_estimates.h"
#include "tests/unit/pipeline/fixture.h"

namespace rigcal::pipeline {
namespace {

using nlohmann::json;
using testing::ElementsAre;
using testing::HasSubstr;

using Places = std::map<SensorId, Se3>;  // in the left camera's frame

class AsFoundTest : public PipelineTest {
 protected:
  static Places AtHome() {
    Places places;
    places[kCameras[0]] = {};
    places[kCameras[1]] = {{-0.5, 0.1, 0.0}, Eigen::Quaterniond(Eigen::AngleAxisd(2.0, Eigen::Vector3d::UnitZ()))};
    places[kCameras[2]] = {{0.3, 0.0, 0.1}, Eigen::Quaterniond(Eigen::AngleAxisd(0.4, Eigen::Vector3d::UnitX()))};
    return places;
  }
  static Places RightMoved(double x_m) {
    Places places = AtHome();
    Se3& right = places[kCameras[2]];
    right.p_m += right.q * Eigen::Vector3d(x_m, 0, 0);
    return places;
  }

  Manifest ManifestOf(int day, const std::vector<SensorId>& remounted) {
    Manifest manifest;
    manifest.header.robot = kRig;
    manifest.header.reference = kCameras[0];
    manifest.header.captured_at = {1'700'000'000'000'000'000 + day * kDay_ns};
    manifest.header.remounted = remounted;
    Target board;
    board.id = TargetId("board");
    board.cols = 9, board.rows = 6, board.square_m = 0.025;
    manifest.header.targets = {board};
    for (const SensorId& camera : kCameras) {
      Sensor sensor;
      sensor.id = camera;
      sensor.sees = board.id;
      manifest.header.sensors.push_back(sensor);
      AddFile(camera.str() + "/01.png", camera.str() + " on day " + std::to_string(day), manifest);
    }
    return manifest;
  }
  static Edge EdgeOf(const SessionId& session, const SensorId& a, const SensorId& b, const Places& places) {
    Edge edge = GivenEdge("r", a.str(), b.str(), 0.0);
    edge.method = "stereo";
    edge.session = session;
    edge.T_a_b = places.at(a).Inverse() * places.at(b);
    edge.id = EstimatedEdgeId(kRig, session, edge.method, a, b);
    return edge;
  }
  // By the session itself: 0.1 mm and 0.1 mrad, 50 degrees of freedom.
  static SessionEstimate EstimateOf(const SessionId& session, const Places& places) {
    SessionEstimate estimate;
    estimate.session = session;
    estimate.reference = kCameras[0];
    for (const SensorId& camera : kCameras)
      estimate.poses.push_back({camera, places.at(camera), camera == kCameras[0] ? 0.0 : 50.0});
    estimate.covariance = 1e-8 * Eigen::MatrixXd::Identity(12, 12);
    return estimate;
  }
  // Sessions from here on have a pair of the left camera and the robot's body, which was driven on a floor.
  void HasBody() { has_body_ = true; }
  static Edge EdgeOfBody(const SessionId& session) {
    Edge edge = EdgeOf(session, kCameras[0], kCameras[1], AtHome());
    edge.frame_b = SensorId("body");
    edge.id = EstimatedEdgeId(kRig, session, edge.method, edge.frame_a, edge.frame_b);
    Matrix6d Omega = edge.uncertainty.Omega;
    Omega.row(tangent::kZ).setZero(), Omega.col(tangent::kZ).setZero();
    edge.uncertainty = FromInformation(Omega, UncertaintySource::kGiven, 0);
    return edge;
  }
  // A session as its pairs and its refinement leave it, and the revision that follows; its number.
  int Visit(int day, const Places& places, const std::vector<SensorId>& remounted = {}, bool refined = true) {
    const SessionId session = Close(ManifestOf(day, remounted));
    StoreEdges({EdgeOf(session, kCameras[0], kCameras[1], places), EdgeOf(session, kCameras[0], kCameras[2], places),
                EdgeOf(session, kCameras[1], kCameras[2], places)});
    if (has_body_) StoreEdges({EdgeOfBody(session)});
    SessionEstimate estimate = EstimateOf(session, places);
    if (!refined)
      estimate.poses.clear(), estimate.covariance.resize(0, 0),
          estimate.why_not = {{"few", "the session is short", "Take more."}};
    EXPECT_TRUE(storage::AppendSessionEstimate(*store_, estimate, kSessionEstimator, clock_.now));
    return Again();
  }
  int Again() {
    const auto revision = Revise(*store_, kRig, clock_);
    EXPECT_TRUE(revision) << Sentence(revision.error());
    newest_ = revision.value_or(Revision{});
    return newest_.number;
  }
  void Decide(storage::Deciding deciding, int revision) {
    const auto done = storage::AppendDecision(*store_, kRig, revision, deciding, {clock_.now, "Ada", "looked at"});
    EXPECT_TRUE(done && *done) << revision;
  }
  void SetPolicy(const std::string& text) {
    const json parameters = {{"text", text}, {"who", "Eve"}, {"reason", "we look at each"}};
    EXPECT_TRUE(CarryOut(*store_, clock_, "set_policy", parameters.dump()));
  }
  AsFound Found(int number) { return storage::LoadAsFound(*store_, {kRig, number}).value().value_or(AsFound{}); }
  json Ask(const std::string& verb) {
    const auto answer = Answer({*store_, clock_, revisions_cache_, clock_.now, ""}, verb, R"({"robot":"r"})");
    EXPECT_TRUE(answer) << Sentence(answer.error());
    return json::parse(answer.value_or("{}"));
  }

  RevisionCache revisions_cache_;
  Revision newest_;
  bool has_body_ = false;
};

TEST_F(AsFoundTest, TheFirstSessionFindsNothingInUse) {
  Visit(0, AtHome());
  const AsFound found = Found(1);
  EXPECT_EQ(found.in_use, 0);
  EXPECT_THAT(found.text, HasSubstr("not tested. No calibration was in use before it."));
  EXPECT_EQ(Ask("show")["as_found"]["why_not"], "No calibration was in use before it.");
}

TEST_F(AsFoundTest, ASessionThatFindsAllInPlaceSaysSo) {
  Visit(0, AtHome());
  Visit(30, RightMoved(5e-5));
  const json found = Ask("show")["as_found"];
  EXPECT_EQ(found["state"], "unchanged") << found;
  EXPECT_EQ(found["in_use"]["revision"], 1);
  EXPECT_EQ(found["relative_to"], "left");
  EXPECT_EQ(found["tests"], 12);
  EXPECT_EQ(found["visits"], 1);
  const json right = found["sensors"][1];
  EXPECT_EQ(right["id"], "right");
  EXPECT_NEAR(right["change"][0].get<double>(), 5e-5, 1e-9);
  EXPECT_NEAR(right["sigma"][0].get<double>(), std::sqrt(2e-8 + 2e-6), 1e-7);  // both sides, and 1 mm of each visit
  EXPECT_NEAR(right["left"][0].get<double>(), 2.5e-5, 1e-8);                   // the middle is what is left
  EXPECT_THAT(found["text"].get<std::string>(), HasSubstr("(session of 2023-12-14"));
}

// Two visits of a robot alone do not tell 5.4 mm from what its sensors scatter by: no drift, and not unchanged.
TEST_F(AsFoundTest, NobodyIsUnchangedWhomTheVerdictHasElsewhere) {
  Visit(0, AtHome());
  Visit(30, RightMoved(5.4e-3));
  ASSERT_THAT(newest_.verdict.why, HasSubstr("right sat 5.4 mm elsewhere"));
  const json found = Ask("show")["as_found"];
  EXPECT_THAT(found["text"].get<std::string>(), HasSubstr("; right not told apart from scatter: 5.4 mm; "));
  EXPECT_EQ(found["state"], "not_measured");
  const json right = found["sensors"][1];
  EXPECT_EQ(right["state"], "not_told_apart") << found;
  EXPECT_EQ(right["axes"][0], "not_told_apart");
  EXPECT_NEAR(std::abs(right["elsewhere"][0].get<double>()), 5.4e-3, 1e-4);
  EXPECT_NEAR(right["change"][0].get<double>(), 5.4e-3, 1e-4) << "its figures are still there";
  EXPECT_EQ(found["sensors"][0]["state"], "unchanged");
}

TEST_F(AsFoundTest, ADriftIsFoundAgainstWhatWasInUseHoweverOftenTheRevisionIsMade) {
  constexpr double kMove_m =
      3e-2;  // two visits of a robot alone say little of how its sensors scatter from visit to visit
  Visit(0, AtHome());
  Visit(30, AtHome());
  EXPECT_EQ(Visit(60, RightMoved(kMove_m)), 3);
  EXPECT_EQ(newest_.verdict.level, VerdictLevel::kFail) << newest_.verdict.why;
  const AsFound found = Found(3);
  EXPECT_EQ(found.in_use, 2);
  EXPECT_THAT(SummaryOf(found).drifted, ElementsAre(SensorId("right")));
  EXPECT_NEAR(found.sensors[1].change(0), kMove_m, 1e-5);
  ASSERT_TRUE(found.sensors[1].rate);
  EXPECT_EQ(found.sensors[1].rate->visits, 3);
  EXPECT_NEAR(found.sensors[1].rate->per_30_days(0), kMove_m / 2, 1e-5);
  EXPECT_EQ(Again(), 4);
  EXPECT_EQ(Found(4).text, found.text);
  EXPECT_EQ(Visit(90, RightMoved(kMove_m)), 5);
  EXPECT_EQ(Found(5).in_use, 2) << "those that failed are in use nowhere";
  const json rows = Ask("revisions")["revisions"];
  EXPECT_EQ(rows[1]["as_found"]["drifted"], json::array({"right"}));
  EXPECT_EQ(rows[3]["as_found"]["state"], "unchanged");
}

TEST_F(AsFoundTest, WhatTheRobotWasRolledBackToIsInUse) {
  Visit(0, AtHome());
  Visit(30, AtHome());
  Decide(storage::Deciding::kRollBack, 1);
  Visit(60, AtHome());
  EXPECT_EQ(Found(3).in_use, 1);
  EXPECT_EQ(storage::LoadInUse(*store_, kRig).value()->revision, 3) << newest_.verdict.why;
  EXPECT_EQ(Again(), 4);
  EXPECT_EQ(Found(4).in_use, 1) << "though a revision with the session is in use since";
}

TEST_F(AsFoundTest, WhatNobodyApprovedIsNotInUse) {
  Visit(0, AtHome());
  Decide(storage::Deciding::kReject, 1);
  Visit(30, AtHome());
  EXPECT_EQ(Found(2).in_use, 0);
  EXPECT_THAT(Found(2).text, HasSubstr("not tested. No calibration was in use before it."));
}

// The robot came in with what was in use then, whatever people decide later.
TEST_F(AsFoundTest, WhatIsDecidedLaterWasNotInUse) {
  Visit(0, AtHome());
  clock_.now.ns += 1'000'000'000;
  Visit(30, AtHome());
  Decide(storage::Deciding::kReject, 1);
  clock_.now.ns += 1'000'000'000;
  Visit(60, AtHome());
  EXPECT_EQ(Found(3).in_use, 2);
  clock_.now.ns += 1'000'000'000;
  Decide(storage::Deciding::kApprove, 1);
  Decide(storage::Deciding::kReject, 2);
  EXPECT_EQ(Again(), 4);
  EXPECT_EQ(Found(4).in_use, 2);
}

// 0.95 mm is a drift after twenty visits of a robot alone, and less than any verdict minds.
TEST_F(AsFoundTest, WhatFoundDriftMayWaitForAPerson) {
  SetPolicy("approve_drift: false");
  for (int week = 0; week < 20; ++week) Visit(7 * week, AtHome());
  Visit(140, RightMoved(9.5e-4));
  EXPECT_EQ(StateOf(Found(21)), FoundState::kDrifted) << Found(21).text;
  EXPECT_NE(newest_.verdict.level, VerdictLevel::kFail) << newest_.verdict.why;
  EXPECT_EQ(storage::LoadInUse(*store_, kRig).value()->revision, 20);
  Decide(storage::Deciding::kApprove, 21);
  EXPECT_EQ(storage::LoadInUse(*store_, kRig).value()->revision, 21);
  EXPECT_EQ(Again(), 22);
  EXPECT_EQ(storage::LoadInUse(*store_, kRig).value()->revision, 21) << "the same drift, so it waits as well";
}

TEST_F(AsFoundTest, ThePolicySetsTheOddsOfAFalseAlarm) {
  SetPolicy("drift_false_alarm_percent: 5");
  Visit(0, AtHome());
  Visit(30, AtHome());
  EXPECT_EQ(Found(2).alpha, 0.05);
}

TEST_F(AsFoundTest, WhatWasRemountedIsNoDrift) {
  Visit(0, AtHome());
  Visit(30, RightMoved(0.02), {SensorId("right")});
  const AsFound found = Found(2);
  EXPECT_EQ(StateOf(found), FoundState::kUnchanged) << found.text;
  EXPECT_THAT(found.text, HasSubstr("rear unchanged; right moved on purpose"));
}

// The remount is in the pose that is in use since, though the rest of the rig was measured before it, and its session
// was never refined: from then on a move is a move.
TEST_F(AsFoundTest, WhatWasRemountedInASessionThatWasNotRefinedIsTestedAfterIt) {
  Visit(0, AtHome());
  Visit(30, RightMoved(0.02), {SensorId("right")}, false);
  if (storage::LoadInUse(*store_, kRig).value()->revision != 2) Decide(storage::Deciding::kApprove, 2);
  Visit(60, RightMoved(0.04));
  const AsFound found = Found(3);
  ASSERT_EQ(found.in_use, 2) << found.text;
  EXPECT_THAT(SummaryOf(found).drifted, ElementsAre(SensorId("right"))) << found.text;
  EXPECT_THAT(found.text, testing::Not(HasSubstr("moved on purpose")));
}

TEST_F(AsFoundTest, ASessionWithoutAnEstimateSaysWhy) {
  Visit(0, AtHome());
  Visit(30, AtHome(), {}, false);
  EXPECT_THAT(Found(2).text,
              HasSubstr("against revision 1): not tested. It could not be refined as a whole: the session is short."));
}

// On a floor the body's height is not measured; the rest of it is tested though nothing was refined.
TEST_F(AsFoundTest, ASessionWithoutAnEstimateThatIsTestedInPartSaysWhyToo) {
  HasBody();
  SetPolicy("sensors:\n  body: {not_needed: [z of left]}");
  Visit(0, AtHome());
  if (const auto in_use = storage::LoadInUse(*store_, kRig).value(); !in_use || in_use->revision != 1)
    Decide(storage::Deciding::kApprove, 1);
  Visit(30, AtHome(), {}, false);
  EXPECT_THAT(Found(2).text, HasSubstr("against revision 1): body unchanged; "));
  EXPECT_THAT(Found(2).text, testing::EndsWith(" It could not be refined as a whole: the session is short."));
  Visit(60, AtHome());
  EXPECT_THAT(Found(3).text, testing::Not(HasSubstr("could not be refined")));
}

TEST_F(AsFoundTest, FinishedEdgesAreNoSession) {
  StoreEdges(Triangle("r"));
  Again();
  EXPECT_FALSE(Ask("show").contains("as_found"));
  EXPECT_FALSE(Ask("revisions")["revisions"][0].contains("as_found"));
}

// What was found depends on the order in which sessions came; the document does not.
TEST_F(AsFoundTest, TheDocumentIsTheSameWhateverTheOrder) {
  Visit(0, AtHome());
  Visit(30, RightMoved(5e-5));
  const Digest in_order = newest_.digest;
  EXPECT_EQ(Found(2).in_use, 1);
  TearDown();
  SetUp();
  Visit(30, RightMoved(5e-5));
  Visit(0, AtHome());
  EXPECT_EQ(newest_.digest, in_order);
  EXPECT_EQ(Found(2).in_use, 0);
}

}  // namespace
}  // namespace rigcal::pipeline
