// Which session's lens belongs to a camera's pose.
#include "server/pipeline/sessions/refined_lenses.h"

#include "server/pipeline/revisions/revise.h"
#include "server/pipeline/revisions/whole_revision.h"
#include "server/pipeline/sessions/session_refinement.h"
#include "storage/sessions/session_estimates.h"
#include "tests/unit/pipeline/fixture.h"

namespace rigcal::pipeline {
namespace {

const SensorId kLeft("left"), kRight("right");
constexpr double kAlone_px = 700;  // focal length that the right camera's own pictures say

CameraIntrinsics LensOf(double focal_px) {
  CameraIntrinsics lens;
  lens.fx_px = lens.fy_px = focal_px, lens.cx_px = 320, lens.cy_px = 240;
  return lens;
}

class RefinedLensesTest : public PipelineTest {
 protected:
  // The right camera, refined with this focal length; 0: its lens was held.
  SessionId Visit(int day, double focal_px, EdgeState state = EdgeState::kGood) {
    Manifest manifest;
    manifest.header.robot = RobotId("r");
    manifest.header.reference = kLeft;
    manifest.header.captured_at = {1'700'000'000'000'000'000 + day * kDay_ns};
    Target board;
    board.id = TargetId("board"), board.cols = 9, board.rows = 6, board.square_m = 0.025;
    manifest.header.targets = {board};
    for (const SensorId& camera : {kLeft, kRight}) {
      manifest.header.sensors.emplace_back().id = camera;
      AddFile(camera.str() + "/01.png", camera.str() + std::to_string(day), manifest);
    }
    const SessionId session = Close(manifest);
    Edge edge = GivenEdge("r", kLeft.str(), kRight.str(), 0.3);
    edge.method = "stereo", edge.session = session, edge.state = state;
    if (state == EdgeState::kFailed) edge.diagnoses = {{"too_few_captures", "too few", "take more"}};
    edge.id = EstimatedEdgeId(edge.robot, session, edge.method, kLeft, kRight);
    StoreEdges({edge});
    SessionEstimate estimate;
    estimate.session = session, estimate.reference = kLeft;
    estimate.poses = {{kLeft, {}, 0.0}, {kRight, edge.T_a_b, 50.0}};
    estimate.covariance = 1e-8 * Eigen::MatrixXd::Identity(6, 6);
    if (focal_px > 0) estimate.lenses = {{kRight, LensOf(focal_px), 0.25 * Eigen::MatrixXd::Identity(9, 9)}};
    EXPECT_TRUE(storage::AppendSessionEstimate(*store_, estimate, kSessionEstimator, clock_.now));
    revision_ = Revise(*store_, RobotId("r"), clock_).value();
    return session;
  }

  report::CameraReport Told(IntrinsicsSource alone = IntrinsicsSource::kEstimated) {
    report::CameraReport camera;
    camera.fit.camera = kRight;
    camera.fit.source = alone;
    camera.fit.intrinsics = LensOf(kAlone_px);
    std::vector<report::CameraReport> cameras = {camera};
    auto whole = LoadWholeRevision(*store_, revision_, Blocks::kLeftOut);
    if (whole && made_by_) whole->solution.fused.made_by = *made_by_;
    EXPECT_TRUE(whole && TakeRefinedLenses(*store_, *whole, cameras));
    return cameras.front();
  }

  Revision revision_;
  std::optional<std::vector<std::string>> made_by_;  // in place of what the revision says
};

TEST_F(RefinedLensesTest, TheNewestSessionBehindThePoseTellsTheLens) {
  Visit(1, 500);
  EXPECT_EQ(Told().fit.intrinsics.fx_px, 500);
  const SessionId newest = Visit(2, 600);
  const report::CameraReport told = Told();
  EXPECT_EQ(told.fit.intrinsics.fx_px, 600);
  EXPECT_EQ(told.fit.sigma, std::vector<double>(9, 0.5));
  EXPECT_EQ(told.refined_in, newest);
}

TEST_F(RefinedLensesTest, AnOlderSessionsLensIsNotTakenWhereTheNewestHeldIts) {
  Visit(1, 500);
  Visit(2, 0);
  const report::CameraReport told = Told();
  EXPECT_EQ(told.fit.intrinsics.fx_px, kAlone_px);
  EXPECT_TRUE(told.refined_in.empty());
}

TEST_F(RefinedLensesTest, GivenNumbersAndThoseOfNoSolutionStay) {
  Visit(1, 500);
  for (const auto alone : {IntrinsicsSource::kGiven, IntrinsicsSource::kNone}) {
    EXPECT_EQ(Told(alone).fit.intrinsics.fx_px, kAlone_px);
    EXPECT_TRUE(Told(alone).refined_in.empty());
  }
}

TEST_F(RefinedLensesTest, OfMoreVisitsThanAreFusedTheRevisionKeepsItsLens) {
  Visit(1, 500);
  const Revision first = revision_;
  for (int day = 2; day < 3 + kSessionsFused; ++day) Visit(day, 500.0 + day);
  EXPECT_EQ(Told().fit.intrinsics.fx_px, 502.0 + kSessionsFused);
  revision_ = first;
  EXPECT_EQ(Told().fit.intrinsics.fx_px, 500);
}

TEST_F(RefinedLensesTest, RefinedAnewByAnotherVersionTheRevisionKeepsItsLens) {
  const SessionId session = Visit(1, 600);
  SessionEstimate before = storage::LoadSessionEstimate(*store_, session, kSessionEstimator).value().value();
  before.lenses.front().intrinsics = LensOf(500);
  ASSERT_TRUE(storage::AppendSessionEstimate(*store_, before, "joint/before", clock_.now));
  EXPECT_EQ(Told().fit.intrinsics.fx_px, 600);
  made_by_ = {"joint/before"};
  EXPECT_EQ(Told().fit.intrinsics.fx_px, 500);
}

TEST_F(RefinedLensesTest, ARevisionThatDoesNotNameItsEstimatesHasThoseOfNow) {
  Visit(1, 500);
  made_by_ = std::vector<std::string>();
  EXPECT_EQ(Told().fit.intrinsics.fx_px, 500);
}

}  // namespace
}  // namespace rigcal::pipeline
