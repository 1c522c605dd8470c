// Runs of re-computation: asked twice they are one, they are drained robot by robot, and what they say of sessions is
// in effect when somebody approved it.
#include "storage/work/recomputations.h"

#include "storage/revisions/decisions.h"
#include "storage/sessions/session_estimates.h"
#include "storage/work/recomputation_result.h"
#include "tests/unit/storage/fixture.h"

namespace rigcal::storage {
namespace {

constexpr const char* kSizes = R"({"board":{"square_m":0.0249,"square_sigma_m":0.0001}})";

class RecomputationsTest : public StoreTest {
 protected:
  static RecomputationRun Run() { return {0, "all", "", "Ada", {50}, "0.2.0", "joint/7"}; }
  RunAsked Ask(const std::vector<RobotAsked>& robots, const RecomputationRun& run = Run()) {
    const auto asked = AppendRecomputation(store_, run, robots);
    EXPECT_TRUE(asked) << WordsOf(asked);
    return asked.value_or(RunAsked{});
  }
  RecomputationItem Next(const std::vector<RobotId>& busy = {}) {
    const auto item = LoadNextRecomputation(store_, busy);
    EXPECT_TRUE(item) << WordsOf(item);
    return item.value_or(std::nullopt).value_or(RecomputationItem{});
  }
  void Finish(SessionAnew how, const std::string& why = "") {
    ASSERT_TRUE(FinishRecomputedSession(store_, Next(), how, why, {60}));
  }
  void FinishRobot(RobotAnew how, int revision = 0, std::vector<PoseChange> changes = {}) {
    const RecomputationItem item = Next();
    ASSERT_TRUE(item.session.empty());
    ASSERT_TRUE(FinishRecomputedRobot(store_, item, {item.robot, how, revision, 0, "", std::move(changes)}, 7, {61}));
  }
  void Estimate(const SessionId& session, const std::string& estimator, double x_m) {
    SessionEstimate estimate;
    estimate.session = session;
    estimate.reference = SensorId("left");
    Se3 T;
    T.p_m.x() = x_m;
    estimate.poses = {{SensorId("left"), Se3{}}, {SensorId("right"), T}};
    estimate.covariance = Eigen::MatrixXd::Identity(6, 6);
    ASSERT_TRUE(AppendSessionEstimate(store_, estimate, estimator, {++made_ns_}));
  }
  // Where the session's estimate in effect has the right camera; 0: there is none.
  double Right(std::int64_t run = 0) {
    const auto rows = LoadSessionEstimates(store_, kRobot, "joint/7", 32, run);
    EXPECT_TRUE(rows) << WordsOf(rows);
    return rows && !rows->empty() && rows->front().estimate ? rows->front().estimate->poses[1].T_ref_sensor.p_m.x()
                                                            : 0.0;
  }

  SessionId session_ = AppendClosedSession(store_, 1, {});
  std::int64_t made_ns_ = 0;
};

TEST_F(RecomputationsTest, AskedTwiceIsOneRunUntilItLeftSomethingOut) {
  const std::vector<RobotAsked> robots = {{kRobot, {{session_, ""}}}};
  const RunAsked first = Ask(robots);
  EXPECT_TRUE(first.is_new);
  EXPECT_EQ(Ask(robots).number, first.number) << "under way";
  Finish(SessionAnew::kComputed);
  FinishRobot(RobotAnew::kUnchanged);
  EXPECT_EQ(Ask(robots).number, first.number) << "done";
  EXPECT_FALSE(Ask(robots).is_new);
  RecomputationRun newer = Run();
  newer.estimator = "joint/8";
  EXPECT_NE(Ask(robots, newer).number, first.number);
  const std::vector<RobotAsked> sized = {{kRobot, {{session_, kSizes}}}};
  ASSERT_TRUE(FinishRecomputedSession(store_, Next(), SessionAnew::kKept, "lost", {60}));
  FinishRobot(RobotAnew::kUnchanged);
  EXPECT_TRUE(Ask(robots, newer).is_new) << "the first left a session out";
  EXPECT_TRUE(Ask(sized).is_new);
}

TEST_F(RecomputationsTest, RobotsAreDoneOneAfterTheOther) {
  const SessionId second = AppendClosedSession(store_, 2, {}), other = AppendClosedSession(store_, 1, {}, kOtherRobot);
  const RunAsked run = Ask({{kRobot, {{session_, ""}, {second, kSizes}}}, {kOtherRobot, {{other, ""}}}});
  EXPECT_EQ(Next().session, session_);
  EXPECT_EQ(Next({kRobot}).session, other) << "a robot that is worked on holds up no other";
  EXPECT_TRUE(Next({kRobot, kOtherRobot}).robot.empty());
  Finish(SessionAnew::kComputed);
  EXPECT_EQ(Next().session, second);
  EXPECT_EQ(Next().sizes, kSizes);
  EXPECT_EQ(LoadRecomputedItem(store_, Next().number).value().value().session, second);
  store_ = Open();  // as after a kill
  Finish(SessionAnew::kSame);
  EXPECT_TRUE(Next().session.empty());
  EXPECT_EQ(Next().robot, kRobot);
  EXPECT_EQ(LoadRecomputationProgress(store_, run.number).value().sessions_done(), 2);
  FinishRobot(RobotAnew::kUnchanged);
  EXPECT_EQ(Next().session, other);
  Finish(SessionAnew::kFailed, "no memory");
  FinishRobot(RobotAnew::kUnchanged);
  EXPECT_TRUE(LoadRecomputationProgress(store_, run.number).value().is_done());
  const auto left = LoadSessionsLeft(store_, run.number, 10).value();
  ASSERT_EQ(left.size(), 1U);
  EXPECT_EQ(left[0].session, other);
  EXPECT_EQ(left[0].how, SessionAnew::kFailed);
}

TEST_F(RecomputationsTest, SessionsThatAreOlderAreCounted) {
  Manifest manifest = MakeManifest(2);
  manifest.header.captured_at.ns += 1;
  ASSERT_TRUE(AppendSession(store_, IdOf(manifest), "{}", manifest, {10}));
  ASSERT_TRUE(AppendHeld(store_, IdOf(manifest), {0, 1}, {11}));
  ASSERT_TRUE(CloseSession(store_, IdOf(manifest), {}, {12}));
  AppendClosedSession(store_, 1, {}, kOtherRobot);
  const RunAsked newest = Ask({{kRobot, {{IdOf(manifest), ""}}}, {kOtherRobot, {}}}),
                 both = Ask({{kRobot, {{session_, ""}, {IdOf(manifest), ""}}}});
  EXPECT_EQ(LoadRecomputationProgress(store_, newest.number).value().older, 1);
  EXPECT_EQ(LoadRecomputationProgress(store_, both.number).value().older, 0);
}

TEST_F(RecomputationsTest, MeasuredSizesAreInEffectOnceApproved) {
  Estimate(session_, "joint/7", 1.0);
  Estimate(session_, EstimatorNamed("joint/7", kSizes), 2.0);
  const RunAsked run = Ask({{kRobot, {{session_, kSizes}}}});
  Finish(SessionAnew::kComputed);
  EXPECT_EQ(Right(), 1.0);
  EXPECT_EQ(Right(run.number), 2.0) << "for the candidate";
  ASSERT_EQ(AppendRevision(store_, MakeRevision(7)).value(), 1);
  FinishRobot(RobotAnew::kChanged, 1);
  EXPECT_EQ(Right(), 1.0) << "nobody approved it";
  ASSERT_TRUE(AppendDecision(store_, kRobot, 1, Deciding::kApprove, {{70}, "Ada", "looked at"}).value());
  EXPECT_EQ(Right(), 2.0);
  EXPECT_EQ(LoadSessionBases(store_, kRobot, 32).value().front().sizes, kSizes);
  ASSERT_TRUE(AppendDecision(store_, kRobot, 1, Deciding::kReject, {{71}, "Ada", "the rule was bent"}).value());
  EXPECT_EQ(Right(), 1.0);
}

// A later revision with the same document is the same calibration: a no to it is a no to the candidate.
TEST_F(RecomputationsTest, MeasuredSizesGoWithACopyOfTheCandidateThatIsRejected) {
  Estimate(session_, "joint/7", 1.0);
  Estimate(session_, EstimatorNamed("joint/7", kSizes), 2.0);
  Ask({{kRobot, {{session_, kSizes}}}});
  Finish(SessionAnew::kComputed);
  ASSERT_EQ(AppendRevision(store_, MakeRevision(7)).value(), 1);
  FinishRobot(RobotAnew::kChanged, 1);
  ASSERT_TRUE(AppendDecision(store_, kRobot, 1, Deciding::kApprove, {{70}, "Ada", "looked at"}).value());
  Revision copy = MakeRevision(7);
  copy.created_at = {75};
  ASSERT_EQ(AppendRevision(store_, copy).value(), 2);
  EXPECT_EQ(Right(), 2.0);
  ASSERT_TRUE(AppendDecision(store_, kRobot, 2, Deciding::kReject, {{80}, "Ada", "the rule was bent"}).value());
  EXPECT_EQ(Right(), 1.0);
  EXPECT_EQ(LoadSessionBases(store_, kRobot, 32).value().front().sizes, "");
  ASSERT_TRUE(AppendDecision(store_, kRobot, 1, Deciding::kApprove, {{90}, "Ada", "it was not"}).value());
  EXPECT_EQ(Right(), 2.0);
}

// Nor is a yes to it anything else than a yes to the candidate, whether or not that was rejected before.
TEST_F(RecomputationsTest, MeasuredSizesComeWithACopyOfTheCandidateThatIsApproved) {
  Estimate(session_, "joint/7", 1.0);
  Estimate(session_, EstimatorNamed("joint/7", kSizes), 2.0);
  const auto decide = [&](int revision, Deciding how, std::int64_t at_ns) {
    return AppendDecision(store_, kRobot, revision, how, {{at_ns}, "Ada", "looked at"}).value();
  };
  const auto revision_made_at = [&](std::int64_t at_ns) {
    Revision revision = MakeRevision(7);
    revision.created_at = {at_ns};
    return AppendRevision(store_, revision).value();
  };
  ASSERT_EQ(revision_made_at(30), 1);  // has the document of the candidate
  ASSERT_TRUE(decide(1, Deciding::kApprove, 35));
  Ask({{kRobot, {{session_, kSizes}}}});
  Finish(SessionAnew::kComputed);
  ASSERT_EQ(revision_made_at(61), 2);
  FinishRobot(RobotAnew::kChanged, 2);
  ASSERT_EQ(revision_made_at(75), 3);
  EXPECT_EQ(Right(), 1.0) << "what was approved before the candidate came is none of it";
  ASSERT_TRUE(decide(3, Deciding::kApprove, 80));
  EXPECT_EQ(LoadInUse(store_, kRobot).value()->revision, 3);
  EXPECT_EQ(Right(), 2.0);
  EXPECT_EQ(LoadSessionBases(store_, kRobot, 32).value().front().sizes, kSizes);
  EXPECT_FALSE(AwaitsPerson(store_, kRobot, 3, 7).value());
  ASSERT_TRUE(decide(2, Deciding::kReject, 82));
  EXPECT_EQ(Right(), 1.0);
  ASSERT_TRUE(decide(3, Deciding::kApprove, 84));
  EXPECT_EQ(Right(), 2.0) << "somebody thought better of it";
  ASSERT_TRUE(decide(1, Deciding::kApprove, 86));
  ASSERT_TRUE(decide(3, Deciding::kApprove, 87));
  ASSERT_TRUE(decide(1, Deciding::kRollBack, 88));
  EXPECT_EQ(Right(), 1.0);
  ASSERT_TRUE(decide(3, Deciding::kApprove, 90));
  EXPECT_EQ(Right(), 2.0) << "after the rollback";
}

// What is in use after a rollback was made by the sizes of before: so is what comes next.
TEST_F(RecomputationsTest, ARollbackBehindTheCandidateTakesItsSizesAlong) {
  Estimate(session_, "joint/7", 1.0);
  Estimate(session_, EstimatorNamed("joint/7", kSizes), 2.0);
  const auto decide = [&](int revision, Deciding how, std::int64_t at_ns) {
    return AppendDecision(store_, kRobot, revision, how, {{at_ns}, "Ada", "looked at"}).value();
  };
  const auto revision_made_at = [&](std::int64_t at_ns) {
    Revision revision = MakeRevision(7);
    revision.created_at = {at_ns};
    revision.document = "{\"made_at\":" + std::to_string(at_ns) + "}";  // no two are one calibration
    revision.digest = DigestOf(revision.document);
    return AppendRevision(store_, revision).value();
  };
  ASSERT_EQ(revision_made_at(40), 1);
  ASSERT_TRUE(decide(1, Deciding::kApprove, 45));
  Ask({{kRobot, {{session_, kSizes}}}});
  Finish(SessionAnew::kComputed);
  ASSERT_EQ(revision_made_at(61), 2);
  FinishRobot(RobotAnew::kChanged, 2);
  ASSERT_TRUE(decide(2, Deciding::kApprove, 70));
  ASSERT_EQ(revision_made_at(75), 3);
  ASSERT_TRUE(decide(3, Deciding::kApprove, 76));
  EXPECT_EQ(Right(), 2.0);
  ASSERT_TRUE(decide(2, Deciding::kRollBack, 77));
  EXPECT_EQ(Right(), 2.0) << "to the candidate, not behind it";
  ASSERT_TRUE(decide(1, Deciding::kRollBack, 80));
  EXPECT_EQ(Right(), 1.0);
  ASSERT_EQ(revision_made_at(85), 4);
  ASSERT_TRUE(decide(4, Deciding::kApprove, 86));
  EXPECT_EQ(Right(), 1.0) << "what was made after the rollback has the sizes of before";
  ASSERT_TRUE(decide(3, Deciding::kApprove, 90));
  EXPECT_EQ(Right(), 2.0) << "made by the measured sizes";
}

TEST_F(RecomputationsTest, AKeptSessionKeepsItsOlderEstimate) {
  Estimate(session_, "joint/5", 5.0);
  Estimate(session_, "joint/6", 6.0);
  EXPECT_EQ(Right(), 0.0) << "not by this estimator";
  const RunAsked run = Ask({{kRobot, {{session_, ""}}}});
  Finish(SessionAnew::kKept, "its files are lost");
  EXPECT_EQ(Right(run.number), 6.0);
  FinishRobot(RobotAnew::kUnchanged);
  EXPECT_EQ(Right(), 6.0) << "what changed nothing needs nobody's approval";
}

TEST_F(RecomputationsTest, AKeptSessionKeepsNoSizeThatNobodyApproved) {
  Estimate(session_, "joint/6", 6.0);
  Estimate(session_, EstimatorNamed("joint/6", kSizes), 6.5);
  const RunAsked run = Ask({{kRobot, {{session_, ""}}}});
  Finish(SessionAnew::kKept, "its files are lost");
  EXPECT_EQ(Right(run.number), 6.0) << "of the sizes that it was pushed with";
}

TEST_F(RecomputationsTest, AKeptSessionKeepsTheLastEstimateThoughTheClockWentBack) {
  Estimate(session_, "joint/5", 5.0);
  made_ns_ = -1000;
  Estimate(session_, "joint/6", 6.0);
  const RunAsked run = Ask({{kRobot, {{session_, ""}}}});
  Finish(SessionAnew::kKept, "its files are lost");
  EXPECT_EQ(Right(run.number), 6.0);
}

TEST_F(RecomputationsTest, AFailedSessionIsAsIfNobodyAsked) {
  Estimate(session_, "joint/7", 1.0);
  const RunAsked run = Ask({{kRobot, {{session_, kSizes}}}});
  Finish(SessionAnew::kFailed, "no memory");
  EXPECT_EQ(Right(run.number), 1.0);
}

TEST_F(RecomputationsTest, ACandidateAwaitsAPersonUntilSomethingIsMeasured) {
  ASSERT_TRUE(Ask({{kRobot, {}}}).is_new);
  ASSERT_EQ(AppendRevision(store_, MakeRevision(5)).value(), 1);
  ASSERT_EQ(AppendRevision(store_, MakeRevision(7)).value(), 2);
  FinishRobot(RobotAnew::kChanged, 2);
  EXPECT_TRUE(AwaitsPerson(store_, kRobot, 2, 7).value());
  EXPECT_TRUE(AwaitsPerson(store_, kRobot, 3, 7).value()) << "as does one that a policy makes of the same edges";
  EXPECT_FALSE(AwaitsPerson(store_, kRobot, 1, 7).value()) << "one of before is none of it";
  EXPECT_FALSE(AwaitsPerson(store_, kRobot, 3, 8).value()) << "a newer edge";
  EXPECT_FALSE(AwaitsPerson(store_, kOtherRobot, 3, 7).value());
  ASSERT_TRUE(AppendDecision(store_, kRobot, 2, Deciding::kApprove, {{70}, "Ada", "looked at"}).value());
  EXPECT_FALSE(AwaitsPerson(store_, kRobot, 3, 7).value());
  const auto cause = LoadCauseOf(store_, {kRobot, 2}).value();
  ASSERT_TRUE(cause);
  EXPECT_EQ(CauseText(*cause), "re-computed with rigcal 0.2.0, estimator joint/7");
  EXPECT_FALSE(LoadCauseOf(store_, {kRobot, 1}).value());
}

TEST_F(RecomputationsTest, TheLargestEffectIsToldFirst) {
  ASSERT_TRUE(AppendRobot(store_, kOtherRobot, {1}));
  const RunAsked run = Ask({{kRobot, {}}, {kOtherRobot, {}}});
  ASSERT_EQ(AppendRevision(store_, MakeRevision(7)).value(), 1);
  ASSERT_EQ(AppendRevision(store_, MakeRevision(7, kOtherRobot)).value(), 1);
  FinishRobot(RobotAnew::kChanged, 1, {{SensorId("rear"), "moved", 0.001, 0.002, 1.5}});
  FinishRobot(RobotAnew::kChanged, 1,
              {{SensorId("left"), "moved", 0.003, 0.004, 0.5}, {SensorId("right"), "moved", 0.0005, 0.006, 4.0}});
  const auto robots = LoadRecomputedRobots(store_, run.number, 10).value();
  ASSERT_EQ(robots.size(), 2U);
  EXPECT_EQ(robots[0].robot, kOtherRobot);
  EXPECT_EQ(robots[0].changes[0].sensor, SensorId("right"));
  EXPECT_EQ(robots[0].changes[0].turned_rad, 0.006);
  EXPECT_EQ(robots[0].changes[1].moved_m, 0.003);
  EXPECT_EQ(robots[1].changes[0].sigma_ratio, 1.5);
  EXPECT_EQ(LoadRecomputedRobots(store_, run.number, 1).value().size(), 1U);
}

TEST_F(RecomputationsTest, WhatIsNotKnownIsRefusedWhole) {
  const auto asked =
      AppendRecomputation(store_, Run(), {{kRobot, {{session_, ""}, {SessionId(DigestOf("none").str()), ""}}}});
  ASSERT_FALSE(asked);
  EXPECT_EQ(asked.error().code, ErrorCode::kNotFound);
  EXPECT_FALSE(LoadRecomputation(store_, 0).value()) << "nothing is left of it";
}

}  // namespace
}  // namespace rigcal::storage
