// What an estimate says of its cameras: residuals are those of the estimate, boards stand where they were put, sigma is
// what leaving pictures out really does.
#include "server/calib/camera/camera_fit.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/unit/calib/virtual_pair.h"

namespace rigcal::calib {
namespace {

CameraProblem ProblemOfA(const StereoProblem& pair) {
  CameraProblem problem{pair.camera_a, pair.board, {}};
  for (const StereoCapture& capture : pair.captures) problem.views.emplace_back(capture.capture, *capture.a);
  return problem;
}

double RmsOf(const CameraFit& fit) {
  double sum_px2 = 0.0, corners = 0.0;
  for (const ViewFit& view : fit.views)
    for (const Eigen::Vector2d& r : view.residual_px) sum_px2 += r.squaredNorm(), corners += 1.0;
  return std::sqrt(sum_px2 / corners);
}

TEST(CameraFitOfAPair, HasTheResidualsOfTheEdge) {
  const VirtualPair pair;
  std::vector<CameraFit> fits;
  const Edge edge = EstimateEdge(Photographed(pair, TiltedBoards(8), 0.3, 5), &fits);
  ASSERT_EQ(edge.state, EdgeState::kGood);
  ASSERT_EQ(fits.size(), 2U);
  EXPECT_EQ(fits[0].camera, edge.frame_a);
  EXPECT_NEAR(RmsOf(fits[0]), edge.figures.at("rms_a_px"), 1e-9);
  EXPECT_NEAR(RmsOf(fits[1]), edge.figures.at("rms_b_px"), 1e-9);
  EXPECT_EQ(fits[1].intrinsics.fx_px, edge.figures.at("fx_b_px"));
  EXPECT_EQ(fits[0].source, IntrinsicsSource::kEstimated);
  EXPECT_TRUE(fits[0].sigma_by_jackknife);
  EXPECT_EQ(fits[0].width_px, pair.width_px);
}

// A board that looks alike when turned, seen turned by the second camera.
TEST(CameraFitOfAPair, FollowsTheTurnOfTheBoard) {
  VirtualPair pair;
  pair.board = Target{TargetId("board"), 8, 6, 0.03, 0.0, ""};
  StereoProblem problem = Photographed(pair, TiltedBoards(8), 0.1, 5);
  problem.captures[2].b = SeenFrom(*problem.captures[2].b, pair.board, 1);
  std::vector<CameraFit> fits;
  const Edge edge = EstimateEdge(problem, &fits);
  ASSERT_EQ(edge.state, EdgeState::kGood);
  EXPECT_NEAR(RmsOf(fits[1]), edge.figures.at("rms_b_px"), 1e-9);
}

TEST(CameraFitOfAPair, SaysWhereCornersWereSeenThoughNothingIsSolved) {
  const VirtualPair pair;
  std::vector<CameraFit> fits;
  const Edge edge = EstimateEdge(Photographed(pair, TiltedBoards(2), 0.1, 5), &fits);
  ASSERT_EQ(edge.state, EdgeState::kFailed);
  ASSERT_EQ(fits.size(), 2U);
  ASSERT_EQ(fits[0].views.size(), 2U);
  EXPECT_EQ(fits[0].source, IntrinsicsSource::kNone);
  EXPECT_EQ(fits[0].views[0].uv_px.size(), 54U);
  EXPECT_TRUE(fits[0].views[0].residual_px.empty());
}

TEST(CameraFitOf, ResidualIsSeenMinusPlaced) {
  const VirtualPair pair;
  const Se3 T_cam_board = BoardAt(pair, {0.02, -0.01, 0.6}, {0.2, 0.1, 0.0});
  CameraProblem problem = ProblemOfA(Photographed(pair, {T_cam_board}, 0.0, 1));
  const CaptureId capture = problem.views[0].first;
  problem.views[0].second.corners_px[7] += Eigen::Vector2d(2.0, -1.0);
  const CameraFit fit = FitOf(problem, pair.a, {{capture, T_cam_board}});
  ASSERT_EQ(fit.views.size(), 1U);
  for (std::size_t i = 0; i < 54; ++i) {
    const Eigen::Vector2d wanted = i == 7 ? Eigen::Vector2d(2.0, -1.0) : Eigen::Vector2d(0.0, 0.0);
    EXPECT_LT((fit.views[0].residual_px[i] - wanted).norm(), 1e-3) << i;
  }
}

TEST(CameraFitOf, TiltSaysWhichSideIsNearer) {
  const VirtualPair pair;
  const auto stand = [&](const Eigen::Vector3d& rotation_rad) {
    const Se3 T_cam_board = BoardAt(pair, {0.0, 0.0, 0.7}, rotation_rad);
    const CameraProblem problem = ProblemOfA(Photographed(pair, {T_cam_board}, 0.0, 1));
    return FitOf(problem, pair.a, {{problem.views[0].first, T_cam_board}}).views.at(0);
  };
  EXPECT_NEAR(stand({0, 0, 0}).distance_m, 0.7, 1e-9);
  EXPECT_LT(stand({0, 0, 0}).tilt_rad.norm(), 1e-9);
  // About y by a positive angle: the right side comes nearer. About x: the lower side goes away.
  EXPECT_LT((stand({0, 0.3, 0}).tilt_rad - Eigen::Vector2d(0.3, 0.0)).norm(), 1e-9);
  EXPECT_LT((stand({0.3, 0, 0}).tilt_rad - Eigen::Vector2d(0.0, -0.3)).norm(), 1e-9);
}

// The oracle solves the camera anew without each picture.
TEST(CameraFitOf, SigmaIsWhatLeavingPicturesOutDoes) {
  const VirtualPair pair;
  const CameraProblem problem = ProblemOfA(Photographed(pair, TiltedBoards(14), 0.3, 11));
  const auto whole = EstimateCamera(problem);
  ASSERT_TRUE(whole);
  const CameraFit fit = FitOf(problem, whole->intrinsics, whole->T_cam_board);
  ASSERT_EQ(fit.sigma.size(), 9U);
  ASSERT_TRUE(fit.sigma_by_jackknife);
  ASSERT_EQ(fit.covariance.rows(), 9);
  for (int i = 0; i < 9; ++i) EXPECT_DOUBLE_EQ(std::sqrt(fit.covariance(i, i)), fit.sigma[static_cast<std::size_t>(i)]);
  std::vector<Eigen::Vector4d> without;
  for (std::size_t k = 0; k < problem.views.size(); ++k) {
    CameraProblem fewer = problem;
    fewer.views.erase(fewer.views.begin() + static_cast<std::ptrdiff_t>(k));
    const auto estimate = EstimateCamera(fewer);
    ASSERT_TRUE(estimate);
    const CameraIntrinsics& values = estimate->intrinsics;
    without.emplace_back(values.fx_px, values.fy_px, values.cx_px, values.cy_px);
  }
  const auto m = static_cast<double>(without.size());
  Eigen::Vector4d mean = Eigen::Vector4d::Zero(), squares = Eigen::Vector4d::Zero();
  for (const Eigen::Vector4d& values : without) mean += values / m;
  for (const Eigen::Vector4d& values : without) squares += (values - mean).cwiseAbs2();
  for (int i = 0; i < 4; ++i) {
    const double wanted_px = std::sqrt((m - 1) / m * squares[i]);
    EXPECT_NEAR(fit.sigma[static_cast<std::size_t>(i)], wanted_px, 0.15 * wanted_px) << i;
  }
}

TEST(CameraFitOf, FewPicturesGiveTheModelsSigmaAndGivenIntrinsicsTheirOwn) {
  const VirtualPair pair;
  CameraProblem problem = ProblemOfA(Photographed(pair, TiltedBoards(4), 0.3, 3));
  const auto estimate = EstimateCamera(problem);
  ASSERT_TRUE(estimate);
  const CameraFit few = FitOf(problem, estimate->intrinsics, estimate->T_cam_board);
  EXPECT_FALSE(few.sigma_by_jackknife);
  ASSERT_EQ(few.sigma.size(), 9U);
  EXPECT_GT(few.sigma[0], 0.0);
  EXPECT_EQ(few.implied_motion.rows(), 6);
  EXPECT_EQ(few.implied_motion.cols(), 9);
  problem.camera.intrinsics = pair.a;
  problem.camera.intrinsics_sigma = std::vector<double>(9, 0.5);
  const CameraFit given = FitOf(problem, pair.a, estimate->T_cam_board);
  EXPECT_EQ(given.source, IntrinsicsSource::kRefined);
  ASSERT_EQ(given.sigma.size(), 9U);
  for (const double sigma : given.sigma) EXPECT_LT(sigma, 0.5);
  problem.camera.intrinsics_sigma = std::vector<double>(9, 1e-9);
  EXPECT_NEAR(FitOf(problem, pair.a, estimate->T_cam_board).sigma[0], 1e-9, 1e-12);
  problem.camera.intrinsics_sigma->at(1) = 0;
  EXPECT_EQ(FitOf(problem, pair.a, estimate->T_cam_board).sigma[1], 0);
  problem.camera.intrinsics_sigma.reset();
  const CameraFit exact = FitOf(problem, pair.a, estimate->T_cam_board);
  EXPECT_TRUE(exact.sigma.empty());
  EXPECT_EQ(exact.covariance.size() + exact.implied_motion.size(), 0);
}

}  // namespace
}  // namespace rigcal::calib
