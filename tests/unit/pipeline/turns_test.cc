// Nobody waits for ever: robots have their jobs done in turn, and edges of a robot that brings more and more are
// revised.
#include "tests/unit/pipeline/fixture.h"

namespace rigcal::pipeline {
namespace {

class PipelineTurnsTest : public PipelineTest {
 protected:
  void StoreUnreadable(const std::string& robot) {
    const std::string text = "no picture " + std::to_string(++stored_);
    StoreSession(robot, {{"left/01.png", text + "l"}, {"right/01.png", text + "r"}});
  }
  std::size_t EdgesOf(const std::string& robot) {
    const auto edges = storage::LoadEdges(*store_, RobotId(robot), false);
    return edges ? edges->size() : 0;
  }
  void StepUntilEdges(int count) {
    for (int step = 0; step < 50 && Count("edge") < count; ++step) ASSERT_TRUE(StepOnce());
    ASSERT_EQ(Count("edge"), count);
  }

  int stored_ = 0;
};

TEST_F(PipelineTurnsTest, ARobotWithManySessionsKeepsNoOtherWaiting) {
  for (int i = 0; i < 4; ++i) StoreUnreadable("first");
  StoreUnreadable("second");
  StoreUnreadable("third");
  StepUntilEdges(3);
  for (const char* robot : {"first", "second", "third"}) EXPECT_EQ(EdgesOf(robot), 1u) << robot;
  StepUntilEdges(6);
  EXPECT_EQ(EdgesOf("first"), 4u);
}

TEST_F(PipelineTurnsTest, EdgesOfARobotWhoseJobsNeverEndAreRevised) {
  StoreEdges(Triangle("r"));
  for (int i = 0; i < 6; ++i) {
    StoreUnreadable("r");
    StoreUnreadable("r");
    ASSERT_TRUE(StepOnce());
  }
  EXPECT_TRUE(revisions_.empty());
  clock_.now.ns += 46'000'000'000;
  ASSERT_TRUE(StepOnce());
  ASSERT_EQ(revisions_.size(), 1u);
  // Half of what a session says is no calibration: nobody is told to use it.
  EXPECT_EQ(revisions_[0].verdict.level, VerdictLevel::kUnknown);
  EXPECT_NE(revisions_[0].verdict.why.find("still to be calibrated"), std::string::npos) << revisions_[0].verdict.why;
  EXPECT_EQ(InUse(), 0);
  for (int i = 0; i < 6; ++i) {
    StoreUnreadable("r");
    StoreUnreadable("r");
    ASSERT_TRUE(StepOnce());
  }
  EXPECT_EQ(revisions_.size(), 1u);
  StepAll();  // until no pair waits
  ASSERT_EQ(revisions_.size(), 2u);
  EXPECT_EQ(revisions_[1].verdict.why.find("still to be calibrated"), std::string::npos);
}

TEST_F(PipelineTurnsTest, WhoTakesNoJobsRevisesAndPublishesWhatIsDue) {
  StepContext context{*store_, clock_, live_, claims_, announcer_, cameras_};
  context.takes_jobs = false;
  const auto step_all = [&] {
    auto result = Step(context);
    while (result && result->worked) result = Step(context);
    return result;
  };
  StoreUnreadable("busy");
  StoreEdges(Triangle("busy"));  // not due: a job of it waits
  StoreEdges(Triangle("other"));
  const auto rested = step_all();
  ASSERT_TRUE(rested) << Sentence(rested.error());
  ASSERT_EQ(revisions_.size(), 1u);
  EXPECT_EQ(revisions_[0].robot, RobotId("other"));
  EXPECT_EQ(Count("published"), 1);
  ASSERT_TRUE(rested->wake_at);  // nobody rings when a robot comes due
  EXPECT_LE(rested->wake_at->ns, clock_.now.ns + 5'000'000'000);
  clock_.now.ns += 46'000'000'000;
  ASSERT_TRUE(step_all());
  ASSERT_EQ(revisions_.size(), 2u);
  EXPECT_EQ(revisions_[1].robot, RobotId("busy"));
  EXPECT_EQ(Count("edge"), 0);
  EXPECT_EQ(EdgesOf("busy"), 3u);
}

TEST_F(PipelineTurnsTest, ARobotThatWaitsForItsRevisionGoesBeforeReportsOfOthers) {
  StoreEdges(Triangle("a"));
  ASSERT_TRUE(StepOnce());
  ASSERT_EQ(revisions_.size(), 1u);
  StoreEdges(Triangle("b"));
  ASSERT_TRUE(StepOnce());  // it has just come
  EXPECT_EQ(Count("published"), 1);
  ASSERT_TRUE(StepOnce());
  ASSERT_EQ(revisions_.size(), 2u);
  StoreEdges(Triangle("c"));
  clock_.now.ns += 11'000'000'000;
  ASSERT_TRUE(StepOnce());
  EXPECT_EQ(Count("published"), 1);
  ASSERT_EQ(revisions_.size(), 3u);
  EXPECT_EQ(revisions_[2].robot, RobotId("c"));
  StepAll();
  EXPECT_EQ(Count("published"), 3);
}

TEST_F(PipelineTurnsTest, ReportsComeWhereRobotsPushWithoutAPause) {
  double x_m = 1.0;
  for (int step = 0; step < 40; ++step) {
    for (const char* robot : {"a", "b"}) {
      std::vector<Edge> edges = {GivenEdge(robot, "left", "right", x_m += 0.001)};
      AssignPushedIds(edges);
      StoreEdges(edges);
    }
    clock_.now.ns += 11'000'000'000;
    ASSERT_TRUE(StepOnce());
  }
  EXPECT_GT(Count("published"), 10);
  EXPECT_GT(revisions_.size(), 10u);
}

TEST_F(PipelineTurnsTest, WhatRobotsUseStaysWhileASessionIsCalibrated) {
  StoreEdges(Triangle("r"));
  StepAll();
  ASSERT_EQ(revisions_.size(), 1u);
  ASSERT_EQ(InUse(), 1);
  StoreUnreadable("r");
  StoreUnreadable("r");
  ASSERT_TRUE(StepOnce());  // one pair of two
  clock_.now.ns += 46'000'000'000;
  ASSERT_TRUE(StepOnce());
  ASSERT_EQ(revisions_.size(), 2u);
  EXPECT_EQ(revisions_[1].verdict.level, VerdictLevel::kUnknown);
  EXPECT_EQ(InUse(), 1);
}

}  // namespace
}  // namespace rigcal::pipeline
