// Work that ends the process, or for which there is no memory: begun so often and no more, beside other robots' work.
#include "storage/work/attempts.h"

#include <gmock/gmock.h>
#include <sys/resource.h>

#include <opencv2/core/version.hpp>
#include <opencv2/imgcodecs.hpp>

#include "server/base/limits_in_force.h"
#include "server/base/process/parallel_for.h"
#include "server/detect/board.h"
#include "storage/revisions/revisions.h"
#include "storage/sessions/detections.h"
#include "storage/work/jobs.h"
#include "tests/unit/pipeline/fixture.h"

namespace rigcal::pipeline {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::Not;

constexpr int kLargeSide_px = 10'000;

std::string BlackPng(int side_px) {
  std::vector<std::uint8_t> bytes;
  cv::imencode(".png", cv::Mat(side_px, side_px, CV_8U, cv::Scalar(0)), bytes);
  return {bytes.begin(), bytes.end()};
}

// So much address space beyond what is used now.
class AddressSpace {
 public:
  explicit AddressSpace(std::int64_t more_bytes) {
    getrlimit(RLIMIT_AS, &before_);
    std::int64_t pages = 0;
    std::ifstream("/proc/self/statm") >> pages;
    rlimit less = before_;
    less.rlim_cur = static_cast<rlim_t>(pages * 4096 + more_bytes);
    setrlimit(RLIMIT_AS, &less);
  }
  ~AddressSpace() { setrlimit(RLIMIT_AS, &before_); }
  AddressSpace(const AddressSpace&) = delete;
  AddressSpace& operator=(const AddressSpace&) = delete;

 private:
  rlimit before_{};
};

class AttemptsPipelineTest : public PipelineTest {
 protected:
  ~AttemptsPipelineTest() override { limits::Enforce({}); }

  // As if the process had died so often in the middle of it.
  void Die(const std::string& work, int times) {
    for (int i = 0; i < times; ++i) ASSERT_TRUE(storage::BeginAttempt(*store_, work, clock_.now));
  }
  SessionId StorePictures(const std::string& robot, const std::string& left) {
    return StoreSession(robot, {{"left/01.png", left}, {"right/01.png", "no picture of " + robot}});
  }
  [[nodiscard]] std::string FirstJob() { return storage::WorkOfJob(storage::LoadNextJob(*store_, {}).value()->number); }
  [[nodiscard]] std::vector<Edge> EdgesOf(const std::string& robot) {
    return storage::LoadEdges(*store_, RobotId(robot), true).value();
  }
  [[nodiscard]] std::string Page(const std::string& robot, const std::string& revision) const {
    std::stringstream page;
    page << std::ifstream(store_->ReportFolder() / robot / revision / "index.html").rdbuf();
    return page.str();
  }
  [[nodiscard]] bool Seen(const std::string& picture) {
    Target board;
    board.id = TargetId("board"), board.cols = 9, board.rows = 6;
    return storage::LoadView(*store_, Sha256Of(picture), detect::DetectorKey(board)).value().has_value();
  }
};

TEST_F(AttemptsPipelineTest, AJobThatEndedTheProcessThriceIsAFailedEdgeAndStopsNobody) {
  const SessionId session = StorePictures("poison", "one");
  Die(FirstJob(), 3);
  StorePictures("r", "two");
  ASSERT_TRUE(StepOnce());
  EXPECT_EQ(EdgesOf("r").size(), 1u);  // before what was begun before
  EXPECT_TRUE(EdgesOf("poison").empty());
  StepAll();
  const auto edges = EdgesOf("poison");
  ASSERT_EQ(edges.size(), 1u);
  EXPECT_EQ(edges[0].state, EdgeState::kFailed);
  EXPECT_EQ(edges[0].method, "stereo");
  EXPECT_EQ(edges[0].session, session);
  EXPECT_THAT(edges[0].diagnoses[0].what,
              HasSubstr("the server died 3 times while it calibrated left and right of robot poison, session " +
                        session.str()));
  EXPECT_THAT(edges[0].diagnoses[0].cure, HasSubstr("fewer or smaller pictures"));
  EXPECT_TRUE(std::filesystem::exists(store_->ReportFolder() / "poison" / "1" / "index.html"));
  EXPECT_TRUE(storage::LoadAttemptCounts(*store_).value().empty());
}

TEST_F(AttemptsPipelineTest, TwoDeathsAndAnOrderlyStopAreNotThree) {
  StorePictures("r", "one");
  const std::string job = FirstJob();
  Die(job, 3);
  ASSERT_TRUE(storage::EndOpenAttempts(*store_, storage::AttemptEnd::kGivenBack, clock_.now));
  StepAll();
  ASSERT_EQ(EdgesOf("r").size(), 1u);
  EXPECT_THAT(EdgesOf("r")[0].diagnoses[0].what, Not(HasSubstr("the server died")));
}

// One piece of work at a time of those that were begun before: nobody is blamed for a neighbour's death.
TEST_F(AttemptsPipelineTest, WhatWasBegunBeforeIsDoneAlone) {
  StorePictures("r", "one");
  Die(FirstJob(), 1);
  ASSERT_TRUE(claims_.Take(RobotId()));  // as another thread that does such work
  EXPECT_EQ(StepAll(), 0);
  claims_.GiveBack(RobotId());
  EXPECT_EQ(StepAll(), 3);
}

TEST_F(AttemptsPipelineTest, WithoutMemoryNothingIsFoundOutAndTheJobIsDoneAgain) {
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
  GTEST_SKIP() << "a sanitizer takes more address space than there is";
#endif
  const std::string black = BlackPng(kLargeSide_px);
  StorePictures("r", black);
  ParallelFor(64, [](std::size_t) {});  // its threads take address space too
  {
    const AddressSpace little(64 << 20);
    const auto step = StepOnce();
    ASSERT_TRUE(step) << Sentence(step.error());
    EXPECT_TRUE(step->wake_at);  // the robot rests
  }
  EXPECT_TRUE(EdgesOf("r").empty());
  EXPECT_FALSE(Seen(black));
  EXPECT_THAT(storage::LoadAttempts(*store_, FirstJob()).value().newest_why, HasSubstr("no memory"));
  clock_.now.ns += 60'000'000'000;
  StepAll();
  ASSERT_EQ(EdgesOf("r").size(), 1u);
  EXPECT_TRUE(Seen(black));
}

// Before, a search without memory was stored as a picture without a board.
TEST_F(AttemptsPipelineTest, WhatAnEarlierVersionSaidIsMadeAgain) {
  const std::string black = BlackPng(100);
  storage::StoredView wrong;
  wrong.view.why_not = "the search for the board failed: std::bad_alloc";
  wrong.view.image_width_px = wrong.view.image_height_px = 100;
  ASSERT_TRUE(storage::AppendView(*store_, Sha256Of(black), "checkerboard-4/opencv-" CV_VERSION "/9x6/board", wrong));
  StorePictures("r", black);
  StepAll();
  ASSERT_EQ(EdgesOf("r").size(), 1u);
  EXPECT_TRUE(Seen(black));
  EXPECT_THAT(revisions_.back().document, Not(HasSubstr("bad_alloc")));
}

TEST_F(AttemptsPipelineTest, AfterThreeTimesWithoutMemoryTheEdgeSaysSo) {
  StorePictures("r", "one");
  const std::string job = FirstJob();
  for (int i = 0; i < 3; ++i) {
    ASSERT_TRUE(storage::BeginAttempt(*store_, job, clock_.now));
    ASSERT_TRUE(storage::EndAttempt(*store_, job, storage::AttemptEnd::kFailed, "std::bad_alloc", clock_.now));
  }
  StepAll();
  ASSERT_EQ(EdgesOf("r").size(), 1u);
  EXPECT_EQ(EdgesOf("r")[0].diagnoses[0].code, "internal");
  EXPECT_THAT(EdgesOf("r")[0].diagnoses[0].what, HasSubstr("it failed 3 times when it calibrated left and right"));
  EXPECT_THAT(EdgesOf("r")[0].diagnoses[0].what, HasSubstr("std::bad_alloc"));
}

TEST_F(AttemptsPipelineTest, APictureBeyondTheServersMemoryIsNamedAndLookedAtAgain) {
  limits::Limits limits;
  limits.decoded_bytes = 16 << 20;
  limits::Enforce(limits);
  const std::string large = BlackPng(2000);
  StorePictures("r", large);
  StepAll();
  ASSERT_EQ(EdgesOf("r").size(), 1u);
  std::string what;
  const auto edges = EdgesOf("r");
  for (const Diagnosis& diagnosis : edges[0].diagnoses) what += diagnosis.what + "\n";
  EXPECT_THAT(what, HasSubstr("file \"left/01.png\" of 2000 x 2000 pixels would take "));
  EXPECT_THAT(what, HasSubstr(" MiB of memory, and this server has 16 MiB for that"));
  EXPECT_FALSE(Seen(large));
  limits::Enforce({});
  clock_.now.ns += 1'000'000'000;
  StorePictures("r", large);
  StepAll();
  EXPECT_TRUE(Seen(large));
}

TEST_F(AttemptsPipelineTest, AReportThatEndedTheProcessThriceComesWithoutItsClouds) {
  StoreEdges(Triangle("poison"));
  StoreEdges(Triangle("r"));
  for (int i = 0; i < 2; ++i) {
    const auto step = StepOnce();  // revised, published later
    ASSERT_TRUE(step && step->worked);
    if (i == 0) Die(storage::WorkOfReport({RobotId("poison"), 1}), 3);
  }
  EXPECT_EQ(Page("poison", "1"), "");  // after all others' work
  StepAll();
  EXPECT_THAT(Page("r", "1"), Not(HasSubstr("The clouds in colour are not shown")));
  EXPECT_THAT(Page("poison", "1"), HasSubstr("The clouds in colour are not shown: the server died 3 times"));
}

TEST_F(AttemptsPipelineTest, AReportThatEndsItWithoutCloudsTooIsPassedOver) {
  StoreEdges(Triangle("poison"));
  ASSERT_TRUE(StepOnce());
  Die(storage::WorkOfReport({RobotId("poison"), 1}), 6);
  StoreEdges(Triangle("r"));
  StepAll();
  EXPECT_NE(Page("r", "1"), "");
  EXPECT_EQ(Page("poison", "1"), "");
}

TEST_F(AttemptsPipelineTest, AGraphThatEndedTheProcessThriceWaitsForAnotherEdge) {
  StoreEdges(Triangle("poison"));
  const auto watermark = storage::LoadEdgeWatermark(*store_, RobotId("poison"));
  Die(storage::WorkOfRevision(RobotId("poison"), watermark.value(), 0), 3);
  StoreEdges(Triangle("r"));
  StepAll();
  EXPECT_EQ(storage::LoadRevisions(*store_, RobotId("r")).value().size(), 1u);
  EXPECT_TRUE(storage::LoadRevisions(*store_, RobotId("poison")).value().empty());
  std::vector<Edge> more = {GivenEdge("poison", "c", "d", 1.0)};
  AssignPushedIds(more);
  StoreEdges(more);
  StepAll();
  EXPECT_EQ(storage::LoadRevisions(*store_, RobotId("poison")).value().size(), 1u);
}

}  // namespace
}  // namespace rigcal::pipeline
