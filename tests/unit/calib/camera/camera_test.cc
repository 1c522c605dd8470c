// One camera by itself: board poses with what is known of them, and intrinsics.
#include <gmock/gmock.h>

#include "server/base/limits.h"
#include "server/calib/camera/camera_memory.h"
#include "server/calib/camera/intrinsics.h"
#include "server/calib/camera/projection.h"
#include "tests/unit/calib/virtual_pair.h"

namespace rigcal::calib {
namespace {

using testing::HasSubstr;

double ViewDifference(const Se3& T, const Se3& S) { return (T.Matrix() - S.Matrix()).cwiseAbs().maxCoeff(); }

CameraProblem ViewsOf(const VirtualPair& pair, const std::vector<Se3>& boards, double sigma_px) {
  const StereoProblem both = Photographed(pair, boards, sigma_px, 3);
  CameraProblem problem{both.camera_a, both.board, {}};
  for (const StereoCapture& capture : both.captures) problem.views.emplace_back(capture.capture, *capture.a);
  return problem;
}

class CameraOfModel : public testing::TestWithParam<CameraModel> {
 protected:
  VirtualPair pair_ = PairOf(GetParam());
  std::vector<Se3> boards_ = GetParam() == CameraModel::kPinholeRadtan ? TiltedBoards(14) : SpreadBoards(14);
};
INSTANTIATE_TEST_SUITE_P(All, CameraOfModel,
                         testing::Values(CameraModel::kPinholeRadtan, CameraModel::kPinholeRational,
                                         CameraModel::kFisheyeKb4, CameraModel::kEucm, CameraModel::kDoubleSphere),
                         [](const auto& tested) { return NameOf(tested.param); });

TEST_P(CameraOfModel, GivenIntrinsicsGiveExactPoses) {
  CameraProblem problem = ViewsOf(pair_, boards_, 0);
  problem.camera.intrinsics = pair_.a;
  const auto estimate = EstimateCamera(problem);
  ASSERT_TRUE(estimate) << estimate.error().what;
  ASSERT_EQ(estimate->T_cam_board.size(), 14U);
  for (std::size_t k = 0; k < boards_.size(); ++k)
    EXPECT_LT(ViewDifference(estimate->T_cam_board.at(problem.views[k].first), boards_[k]), 1e-8) << k;
  EXPECT_EQ(estimate->intrinsics.distortion, pair_.a.distortion);
  EXPECT_LT(estimate->rms_px, 1e-7);
}

TEST_P(CameraOfModel, AbsentIntrinsicsAreEstimated) {
  const auto estimate = EstimateCamera(ViewsOf(pair_, boards_, 0));
  ASSERT_TRUE(estimate) << estimate.error().what;
  EXPECT_EQ(estimate->intrinsics.model, GetParam());
  EXPECT_NEAR(estimate->intrinsics.fx_px, pair_.a.fx_px, 1e-3);
  EXPECT_NEAR(estimate->intrinsics.cy_px, pair_.a.cy_px, 1e-3);
  EXPECT_LT(ViewDifference(estimate->T_cam_board.at(CaptureId("005")), boards_[5]), 1e-6);
}

TEST_P(CameraOfModel, ResidualsAreThoseOfTheNoise) {
  CameraProblem problem = ViewsOf(pair_, boards_, 0.2);
  problem.camera.intrinsics = pair_.a;
  const auto estimate = EstimateCamera(problem);
  ASSERT_TRUE(estimate);
  EXPECT_NEAR(std::sqrt(estimate->variance_px2), 0.2, 0.02);
  EXPECT_NEAR(estimate->rms_px, 0.2 * std::sqrt(2.0), 0.03);
}

// J^T J against differences of the projected corners.
TEST_P(CameraOfModel, InformationIsThatOfTheCorners) {
  CameraProblem problem = ViewsOf(pair_, boards_, 0);
  problem.camera.intrinsics = pair_.a;
  const auto estimate = EstimateCamera(problem);
  ASSERT_TRUE(estimate);
  const IntrinsicsVector values = VectorOf(pair_.a);
  Matrix6d expected = Matrix6d::Zero();
  for (const Eigen::Vector3d& p_board : TargetPoints(problem.board)) {
    Eigen::Matrix<double, 2, 6> slope;
    for (int i = 0; i < 6; ++i) {
      const Se3 ahead = boards_[4] * Se3::Exp(1e-6 * Vector6d::Unit(i));
      const Se3 behind = boards_[4] * Se3::Exp(-1e-6 * Vector6d::Unit(i));
      slope.col(i) =
          (Project(GetParam(), values, ahead * p_board).uv_px - Project(GetParam(), values, behind * p_board).uv_px) /
          2e-6;
    }
    expected += slope.transpose() * slope;
  }
  EXPECT_LT((estimate->information.at(CaptureId("004")) - expected).norm(), 1e-6 * expected.norm());
}

TEST_P(CameraOfModel, AWarmStartLeavesOneOut) {
  CameraProblem problem = ViewsOf(pair_, boards_, 0.1);
  const auto all = EstimateCamera(problem);
  ASSERT_TRUE(all) << all.error().what;
  problem.views.erase(problem.views.begin() + 2);
  const auto warm = EstimateCamera(problem, &*all), cold = EstimateCamera(problem);
  ASSERT_TRUE(warm && cold);
  EXPECT_EQ(warm->T_cam_board.size(), 13U);
  EXPECT_LT(ViewDifference(warm->T_cam_board.at(CaptureId("007")), cold->T_cam_board.at(CaptureId("007"))), 1e-6);
}

// Seen near the edge of a lens of 190 degrees: half of the board lies beyond 90 degrees.
TEST(FisheyeCamera, BoardsBesideTheCameraHavePoses) {
  VirtualPair pair = PairOf(CameraModel::kFisheyeKb4);
  pair.a = {180, 180, 319.5, 239.5, {0.01, -0.004, 0.001, -0.0001}, CameraModel::kFisheyeKb4};
  const IntrinsicsVector values = VectorOf(pair.a);
  Se3 beside = BoardAt(pair, {0.4, 0.02, 0.01}, {0.1, 1.3, 0.2});
  CameraProblem problem;
  problem.camera.intrinsics = pair.a;
  problem.board = pair.board;
  BoardView view{true, "", pair.board.id, 640, 480, {}};
  int behind = 0;
  for (const Eigen::Vector3d& p_board : TargetPoints(pair.board)) {
    const Eigen::Vector3d p_cam = beside * p_board;
    behind += p_cam.z() < 0 ? 1 : 0;
    view.corner_idx.push_back(static_cast<int>(view.corners_px.size()));
    view.corners_px.push_back(Project(pair.a.model, values, p_cam).uv_px);
  }
  ASSERT_GT(behind, 10);
  ASSERT_LT(behind, 44);
  problem.views.emplace_back(CaptureId("001"), view);
  const auto estimate = EstimateCamera(problem);
  ASSERT_TRUE(estimate) << estimate.error().what;
  EXPECT_LT(ViewDifference(estimate->T_cam_board.begin()->second, beside), 1e-8);
}

TEST(Camera, ASmallFarBoardKeepsItsSecondPose) {
  VirtualPair pair;
  pair.board.square_m = 0.004;
  const Se3 board = BoardAt(pair, {0.02, 0.01, 1.0}, {0.3, 0.25, 0});
  CameraProblem problem = ViewsOf(pair, {board, BoardAt(pair, {0.02, 0.01, 0.15}, {0.3, 0.25, 0})}, 0.3);
  problem.camera.intrinsics = pair.a;
  const auto estimate = EstimateCamera(problem);
  ASSERT_TRUE(estimate) << estimate.error().what;
  ASSERT_EQ(estimate->alternatives.count(CaptureId("000")), 1U);
  EXPECT_EQ(estimate->alternatives.count(CaptureId("001")), 0U);
  // One of the two is the truth, but for the noise.
  const auto angle_to_truth = [&](const Se3& T) { return (board.Inverse() * T).Log().tail<3>().norm(); };
  EXPECT_LT(std::min(angle_to_truth(estimate->T_cam_board.at(CaptureId("000"))),
                     angle_to_truth(estimate->alternatives.at(CaptureId("000"))[0])),
            0.3);
}

TEST(Camera, ViewsThatCannotBeUsedAreNamed) {
  CameraProblem problem = ViewsOf(VirtualPair(), TiltedBoards(6), 0.1);
  problem.camera.intrinsics = VirtualPair().a;
  problem.views[1].second = NotFoundView();
  problem.views[3].second = Part(problem.views[3].second, problem.board, 2, 3);
  for (Eigen::Vector2d& uv_px : problem.views[4].second.corners_px) uv_px.x() += 200 * std::sin(0.1 * uv_px.y());
  const auto estimate = EstimateCamera(problem);
  ASSERT_TRUE(estimate) << estimate.error().what;
  EXPECT_EQ(estimate->T_cam_board.size(), 3U);
  EXPECT_THAT(estimate->unused.at(CaptureId("001")), HasSubstr("no 9 x 6 board"));
  EXPECT_THAT(estimate->unused.at(CaptureId("003")), HasSubstr("one line"));
  EXPECT_THAT(estimate->unused.at(CaptureId("004")), HasSubstr("no pose of the board explains"));
}

void ExpectRefused(const CameraProblem& problem, const std::string& code, const std::string& what) {
  const auto estimate = EstimateCamera(problem);
  ASSERT_FALSE(estimate);
  EXPECT_EQ(estimate.error().code, code);
  EXPECT_THAT(estimate.error().what, HasSubstr(what));
  EXPECT_FALSE(estimate.error().cure.empty());
}

TEST(Camera, WhatCannotBeDoneIsSaid) {
  const VirtualPair pair;
  ExpectRefused(ViewsOf(pair, TiltedBoards(2), 0.1), "too_few_captures",
                "front_left sees target 'board' in only 2 of 2");
  CameraProblem none = ViewsOf(pair, TiltedBoards(2), 0.1);
  none.camera.intrinsics = pair.a;
  for (auto& [capture, view] : none.views) view = NotFoundView();
  ExpectRefused(none, "too_few_captures", "no 9 x 6 board in the picture");
  ExpectRefused(none, "too_few_captures", "sees target 'board' in none of 2 captures; at least");
  none.views.clear();
  ExpectRefused(none, "too_few_captures", "in no capture: none has a usable picture of it; at least");
  CameraProblem resized = ViewsOf(pair, TiltedBoards(6), 0.1);
  resized.views[2].second.image_width_px = 1280;
  ExpectRefused(resized, "image_size_changed", "those of 002");
  std::vector<Se3> flat;
  for (int k = 0; k < 8; ++k) flat.push_back(BoardAt(pair, {0.02 * k, 0.01 * k, 0.5}, Eigen::Vector3d::Zero()));
  ExpectRefused(ViewsOf(pair, flat, 0.1), "no_tilt", "front_left");
  CameraProblem noisy = ViewsOf(pair, TiltedBoards(8), 3.0);
  noisy.camera.intrinsics = pair.a;
  ExpectRefused(noisy, "high_residual", "px rms");
}

TEST(Camera, ARationalLensInTheMiddleOfThePictureIsADiagnosis) {
  VirtualPair pair;
  pair.a.model = CameraModel::kPinholeRational;
  pair.a.distortion.resize(8);
  const auto estimate = EstimateCamera(ViewsOf(pair, TiltedBoards(8), 0.2));
  ASSERT_FALSE(estimate);
  EXPECT_THAT(estimate.error().what, HasSubstr("front_left"));
  EXPECT_FALSE(estimate.error().cure.empty());
}

TEST(CameraMemory, SolvesEveryProblemOnceWhileItIsAmongTheNewest) {
  int solved = 0;
  CameraMemory memory([&](const CameraProblem& problem) {
    ++solved;
    return EstimateCamera(problem);
  });
  const VirtualPair pair = PairOf(CameraModel::kPinholeRadtan);
  CameraProblem problem = ViewsOf(pair, TiltedBoards(3), 0.2);
  problem.camera.intrinsics = pair.a;
  const auto first = memory.Estimate(problem), again = memory.Estimate(problem), direct = EstimateCamera(problem);
  ASSERT_TRUE(first && again && direct);
  EXPECT_EQ(solved, 1);
  EXPECT_EQ(first->T_cam_board, direct->T_cam_board);
  EXPECT_EQ(again->T_cam_board, direct->T_cam_board);
  CameraProblem moved = problem;
  moved.views[1].second.corners_px[7].x() += 1e-9;
  ASSERT_TRUE(memory.Estimate(moved));
  EXPECT_EQ(solved, 2);
  moved = problem;
  moved.board.square_m *= 1.001;
  ASSERT_TRUE(memory.Estimate(moved));
  EXPECT_EQ(solved, 3);
  moved = problem;
  moved.camera.intrinsics_sigma = std::vector<double>(9, 1.0);
  ASSERT_TRUE(memory.Estimate(moved));
  EXPECT_EQ(solved, 4);
  ASSERT_TRUE(memory.Estimate(problem));
  EXPECT_EQ(solved, 4);
  for (std::size_t k = 0; k <= limits::kCameraMemoryViewsMax / 4; ++k) {  // four per problem of three views
    moved.board.square_m = 0.05 + 1e-5 * static_cast<double>(k);
    moved.views.resize(3);
    ASSERT_TRUE(memory.Estimate(moved));
  }
  const int before = solved;
  ASSERT_TRUE(memory.Estimate(moved));
  EXPECT_EQ(solved, before);
  ASSERT_TRUE(memory.Estimate(problem));
  EXPECT_EQ(solved, before + 1);
}

TEST(CameraMemory, ForgetsAnAnswerThatBrokeOff) {
  int solved = 0;
  CameraMemory memory([&](const CameraProblem& problem) -> tl::expected<CameraEstimate, Diagnosis> {
    if (++solved == 1) return tl::unexpected(Diagnosis{"internal", "no memory", "Report this."});
    return EstimateCamera(problem);
  });
  CameraProblem problem = ViewsOf(PairOf(CameraModel::kPinholeRadtan), TiltedBoards(5), 0.2);
  EXPECT_FALSE(memory.Estimate(problem));
  EXPECT_TRUE(memory.Estimate(problem));
  EXPECT_TRUE(memory.Estimate(problem));
  EXPECT_EQ(solved, 2);
}

TEST(CameraMemory, RemembersThatThereIsNoAnswer) {
  int solved = 0;
  CameraMemory memory([&](const CameraProblem& problem) {
    ++solved;
    return EstimateCamera(problem);
  });
  const CameraProblem two_views = ViewsOf(PairOf(CameraModel::kPinholeRadtan), TiltedBoards(2), 0.2);
  for (int k = 0; k < 2; ++k) EXPECT_FALSE(memory.Estimate(two_views));
  EXPECT_EQ(solved, 1);
}

}  // namespace
}  // namespace rigcal::calib
