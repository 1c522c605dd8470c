// Intrinsics that were given with sigmas: the views refine them within those. Without a sigma they are held, with an
// endless one they are as good as absent.
#include <ceres/cost_function.h>
#include <gmock/gmock.h>

#include <random>

#include "server/calib/camera/intrinsics.h"
#include "server/calib/core/costs.h"
#include "server/calib/motion/hand_eye.h"
#include "server/math/statistics.h"
#include "tests/unit/calib/virtual_motion.h"
#include "tests/unit/calib/virtual_pair.h"

namespace rigcal::calib {
namespace {

const std::vector<double> kSigma = {1, 1, 1, 1, 0.005, 0.02, 0.0005, 0.0005, 0};

// A calibration beforehand that is off by what it says of itself.
void Give(const CameraIntrinsics& truth, const std::vector<double>& sigma, unsigned seed, Sensor& camera) {
  std::mt19937 random(seed);
  std::normal_distribution<double> normal;
  IntrinsicsVector given = VectorOf(truth);
  for (std::size_t i = 0; i < sigma.size(); ++i) given[static_cast<Eigen::Index>(i)] += sigma[i] * normal(random);
  camera.intrinsics = IntrinsicsOf(truth.model, given);
  camera.intrinsics_sigma = sigma;
}

StereoProblem GivenPair(const std::vector<double>& sigma, unsigned seed) {
  const VirtualPair pair;
  StereoProblem problem = Photographed(pair, TiltedBoards(14), 0.1, seed);
  Give(pair.a, sigma, 1000 + seed, problem.camera_a);
  Give(pair.b, sigma, 2000 + seed, problem.camera_b);
  return problem;
}

std::vector<double> Times(double factor) {
  std::vector<double> sigma = kSigma;
  for (double& value : sigma) value *= factor;
  return sigma;
}

CameraProblem CameraOf(const StereoProblem& pair) {
  CameraProblem problem{pair.camera_a, pair.board, {}};
  for (const StereoCapture& capture : pair.captures) problem.views.emplace_back(capture.capture, *capture.a);
  return problem;
}

Vector6d Between(const Se3& T, const Se3& S) { return (T.Inverse() * S).Log(); }

TEST(GivenIntrinsicsCost, PullsByDifferenceOverSigma) {
  Sensor camera;
  Give(VirtualPair().a, kSigma, 1, camera);
  const IntrinsicsPull pull = PullOf(camera, 0.2);
  const auto cost = MakeGivenIntrinsicsCost(CameraModel::kPinholeRadtan, pull);
  IntrinsicsVector at = pull.given;
  at[2] += 3;
  at[8] += 5;  // its sigma is 0: another rule holds it
  const double* block = at.data();
  std::vector<double> residuals(9), jacobian(81);
  double* jacobians[] = {jacobian.data()};
  ASSERT_TRUE(cost->Evaluate(&block, residuals.data(), jacobians));
  EXPECT_NEAR(residuals[2], 0.2 * 3 / kSigma[2], 1e-12);
  EXPECT_EQ(residuals[8], 0);
  EXPECT_NEAR(jacobian[2 * 9 + 2], 0.2 / kSigma[2], 1e-12);
  EXPECT_EQ(jacobian[2 * 9 + 3], 0);
}

TEST(GivenIntrinsics, WithTinySigmasAreHeld) {
  StereoProblem problem = GivenPair(kSigma, 1);
  problem.camera_a.intrinsics_sigma = problem.camera_b.intrinsics_sigma = Times(1e-7);
  StereoProblem held = problem;
  held.camera_a.intrinsics_sigma.reset();
  held.camera_b.intrinsics_sigma.reset();
  const auto refined = Estimate(problem), as_given = Estimate(held);
  ASSERT_TRUE(refined && as_given);
  EXPECT_LT(Between(refined->T_a_b, as_given->T_a_b).norm(), 1e-7);
  EXPECT_LT((refined->C_model - as_given->C_model).norm(), 1e-3 * as_given->C_model.norm());
}

TEST(GivenIntrinsics, WithEndlessSigmasAreAsGoodAsAbsent) {
  StereoProblem problem = GivenPair(kSigma, 2);
  problem.camera_a.intrinsics_sigma = problem.camera_b.intrinsics_sigma = std::vector<double>(9, 1e5);
  StereoProblem absent = problem;
  for (Sensor* camera : {&absent.camera_a, &absent.camera_b})
    camera->intrinsics.reset(), camera->intrinsics_sigma.reset();
  const auto refined = Estimate(problem), estimated = Estimate(absent);
  ASSERT_TRUE(refined && estimated);
  EXPECT_LT(Between(refined->T_a_b, estimated->T_a_b).norm(), 1e-6);
  EXPECT_NEAR(refined->intrinsics_b.fx_px, estimated->intrinsics_b.fx_px, 1e-4);
  for (const Vector6d& shift : refined->shifts_a) EXPECT_LT(shift.norm(), 1e-5);
}

TEST(GivenIntrinsics, WhoseSigmaIsZeroStayAsGiven) {
  const StereoProblem problem = GivenPair(kSigma, 3);
  const auto estimate = Estimate(problem);
  const auto camera = EstimateCamera(CameraOf(problem));
  ASSERT_TRUE(estimate && camera);
  for (const CameraIntrinsics& refined : {estimate->intrinsics_a, camera->intrinsics}) {
    EXPECT_EQ(refined.distortion[4], problem.camera_a.intrinsics->distortion[4]);
    EXPECT_NE(refined.fx_px, problem.camera_a.intrinsics->fx_px);
  }
}

// 24 pairs of 6 numbers; a ratio of 0.6 against the held ones is far below what they reach.
TEST(GivenIntrinsics, RefinedPairsAreNearerToTheTruthAndWithinTheirSigmas) {
  constexpr int kPairs = 24;
  const Se3 truth = VirtualPair().T_a_b;
  double refined_m2 = 0, held_m2 = 0, squares = 0;
  for (unsigned seed = 0; seed < kPairs; ++seed) {
    StereoProblem problem = GivenPair(kSigma, seed);
    const Edge edge = EstimateEdge(problem);
    ASSERT_EQ(edge.state, EdgeState::kGood);
    const Vector6d error = Between(edge.T_a_b, truth);
    refined_m2 += error.head<3>().squaredNorm();
    const double statistic = error.dot(edge.uncertainty.Omega * error);
    EXPECT_LT(statistic, HotellingLimit(14, 6, 1 - 1e-8)) << seed;
    squares += statistic / 6 / kPairs;
    problem.camera_a.intrinsics_sigma.reset();
    problem.camera_b.intrinsics_sigma.reset();
    const auto held = Estimate(problem);
    ASSERT_TRUE(held);
    held_m2 += Between(held->T_a_b, truth).head<3>().squaredNorm();
  }
  EXPECT_LT(std::sqrt(refined_m2), 0.6 * std::sqrt(held_m2));
  EXPECT_GT(squares, 0.4);
  EXPECT_LT(squares, 3.0);
}

TEST(GivenIntrinsics, BringAShiftEach) {
  StereoProblem problem = GivenPair(kSigma, 5);
  const auto estimate = Estimate(problem);
  ASSERT_TRUE(estimate);
  ASSERT_EQ(estimate->shifts_b.size(), 8U);
  problem.camera_b.intrinsics->cx_px += kSigma[2];
  const auto moved = Estimate(problem);
  ASSERT_TRUE(moved);
  const Vector6d shift = Between(estimate->T_a_b, moved->T_a_b);
  EXPECT_LT((shift - estimate->shifts_b[2]).norm(), 0.03 * shift.norm());
}

TEST(GivenIntrinsics, OneViewIsEnoughForACamera) {
  CameraProblem problem = CameraOf(GivenPair(kSigma, 6));
  problem.views.resize(1);
  const auto estimate = EstimateCamera(problem);
  ASSERT_TRUE(estimate) << estimate.error().what;
  EXPECT_EQ(estimate->T_cam_board.size(), 1U);
  EXPECT_LT(std::abs(estimate->intrinsics.fx_px - problem.camera.intrinsics->fx_px), 3 * kSigma[0]);
}

TEST(GivenIntrinsics, VariantsAreWhatEstimatingAgainGives) {
  CameraProblem problem = CameraOf(GivenPair(kSigma, 7));
  const auto estimate = EstimateCamera(problem);
  ASSERT_TRUE(estimate);
  const CaptureId gone = problem.views[3].first, kept = problem.views[5].first;
  CameraProblem moved = problem, fewer = problem;
  moved.camera.intrinsics->fx_px += 2 * kSigma[0];
  fewer.views.erase(fewer.views.begin() + 3);
  const auto again_moved = EstimateCamera(moved, &*estimate), again_fewer = EstimateCamera(fewer, &*estimate);
  ASSERT_TRUE(again_moved && again_fewer);
  const CameraEstimate closed_moved = WithGiven(*estimate, 0, 2), closed_fewer = WithoutViews(*estimate, {gone});
  EXPECT_FALSE(closed_fewer.T_cam_board.contains(gone));
  for (const auto& [closed, again] :
       {std::pair(&closed_moved, &*again_moved), std::pair(&closed_fewer, &*again_fewer)}) {
    const double change_px = again->intrinsics.fx_px - estimate->intrinsics.fx_px;
    EXPECT_NEAR(closed->intrinsics.fx_px - estimate->intrinsics.fx_px, change_px, 0.05 * std::abs(change_px));
    const Vector6d follows = Between(estimate->T_cam_board.at(kept), again->T_cam_board.at(kept));
    EXPECT_GT(follows.norm(), 1e-6);
    EXPECT_LT(Between(closed->T_cam_board.at(kept), again->T_cam_board.at(kept)).norm(), 0.05 * follows.norm());
  }
}

// What corners and given values do adds up to H^-1 (s^2 N + W^2 s_0^2) H^-1 of views N and weights W, H = N + W^2.
TEST(GivenIntrinsics, ChangesByCornersAndByTheGivenMakeTheCovariance) {
  std::vector<double> sigma = kSigma;
  sigma[5] = 0;
  const auto estimate = EstimateCamera(CameraOf(GivenPair(sigma, 9)));
  ASSERT_TRUE(estimate);
  Eigen::MatrixXd N = Eigen::MatrixXd::Zero(9, 9), W2 = N, changed = N;
  for (const auto& [capture, view] : estimate->of_intrinsics) N += view.information.topLeftCorner<9, 9>();
  for (int i = 0; i < 9; ++i) W2(i, i) = std::pow(estimate->pull.Weight(i), 2);
  for (const IntrinsicsVector& change : ChangesByCorners(*estimate))
    changed += change.head<9>() * change.head<9>().transpose();
  const IntrinsicsVector at = VectorOf(estimate->intrinsics);
  for (int i = 0; i < 9; ++i) {
    const Eigen::VectorXd change = (VectorOf(WithGiven(*estimate, i, 1).intrinsics) - at).head<9>();
    changed += change * change.transpose();
  }
  const double s2 = std::max(estimate->variance_px2, std::pow(estimate->pull.corner_sigma_px, 2));
  const std::vector<int> free = {0, 1, 2, 3, 4, 6, 7};
  const Eigen::MatrixXd inverse = Eigen::MatrixXd(Eigen::MatrixXd(N + W2)(free, free)).inverse();
  const Eigen::MatrixXd inside = s2 * N + std::pow(estimate->pull.corner_sigma_px, 2) * W2;
  const Eigen::MatrixXd expected = inverse * inside(free, free) * inverse;
  const Eigen::VectorXd unit = expected.diagonal().cwiseSqrt().cwiseInverse();
  EXPECT_LT((unit.asDiagonal() * (changed(free, free) - expected) * unit.asDiagonal()).cwiseAbs().maxCoeff(), 1e-6);
  EXPECT_EQ(changed.row(5).norm() + changed.row(8).norm(), 0);
}

TEST(GivenIntrinsics, ThatThePicturesContradictAreNamed) {
  const auto told = [](const std::vector<Diagnosis>& notes) {
    return testing::Value(notes, testing::Contains(testing::Field(&Diagnosis::code, "given_intrinsics_disagree")));
  };
  StereoProblem pair = GivenPair(kSigma, 8);
  EXPECT_FALSE(told(EstimateEdge(pair).diagnoses));
  pair.camera_b.intrinsics->cx_px += 30;
  const Edge edge = EstimateEdge(pair);
  ASSERT_TRUE(told(edge.diagnoses));
  EXPECT_THAT(edge.diagnoses.back().what, testing::HasSubstr("front_right put cx"));
  const VirtualView view;
  HandEyeProblem moving = TwoCameras(Looking(view, 30, 0.25, 0.15, 8), view, true, 8);
  moving.a.sensor.intrinsics_sigma = kSigma;
  EXPECT_FALSE(told(EstimateHandEyeEdge(moving).diagnoses));
  moving.a.sensor.intrinsics->fx_px += 30;  // and fy not: the views tell their ratio
  const Edge contradicted = EstimateHandEyeEdge(moving);
  ASSERT_EQ(contradicted.state, EdgeState::kGood) << contradicted.diagnoses.front().what;
  EXPECT_TRUE(told(contradicted.diagnoses));
}

HandEyeProblem GivenCameras(const std::vector<double>& sigma, unsigned seed) {
  const VirtualView view;
  HandEyeProblem problem = TwoCameras(Looking(view, 30, 0.25, 0.15, seed), view, true, seed);
  Give(view.camera, sigma, 3000 + seed, problem.a.sensor);
  Give(view.camera, sigma, 4000 + seed, problem.b.sensor);
  return problem;
}

TEST(GivenIntrinsics, OfMovingCamerasLieBetweenHeldAndAbsent) {
  HandEyeProblem problem = GivenCameras(kSigma, 1), held = problem, absent = problem;
  for (HandEyeSide* side : {&held.a, &held.b}) side->sensor.intrinsics_sigma.reset();
  for (HandEyeSide* side : {&absent.a, &absent.b})
    side->sensor.intrinsics.reset(), side->sensor.intrinsics_sigma.reset();
  const auto as_given = EstimateHandEye(held), estimated = EstimateHandEye(absent);
  for (HandEyeSide* side : {&problem.a, &problem.b}) side->sensor.intrinsics_sigma = Times(1e-7);
  const auto tiny = EstimateHandEye(problem);
  for (HandEyeSide* side : {&problem.a, &problem.b}) side->sensor.intrinsics_sigma = std::vector<double>(9, 1e5);
  const auto endless = EstimateHandEye(problem);
  ASSERT_TRUE(as_given && estimated && tiny && endless);
  const Vector6d apart = Between(as_given->estimate.T_a_b, estimated->estimate.T_a_b);
  EXPECT_LT(Between(tiny->estimate.T_a_b, as_given->estimate.T_a_b).norm(), 1e-3 * apart.norm());
  EXPECT_LT(Between(endless->estimate.T_a_b, estimated->estimate.T_a_b).norm(), 0.02 * apart.norm());
}

// As for pairs: the refined ones are nearer, and every error is within what is claimed.
TEST(GivenIntrinsics, RefinedMovingCamerasAreNearerToTheTruthAndWithinTheirSigmas) {
  constexpr int kBodies = 12;
  double refined_m2 = 0, held_m2 = 0;
  for (unsigned seed = 0; seed < kBodies; ++seed) {
    const Se3 truth = Looking(VirtualView(), 30, 0.25, 0.15, seed).X;
    HandEyeProblem problem = GivenCameras({3, 3, 3, 3, 0.01, 0, 0, 0, 0}, seed);
    const auto refined = EstimateHandEye(problem);
    for (HandEyeSide* side : {&problem.a, &problem.b}) side->sensor.intrinsics_sigma.reset();
    const auto held = EstimateHandEye(problem);
    ASSERT_TRUE(refined && held);
    const Vector6d error = Between(refined->estimate.T_a_b, truth);
    refined_m2 += error.head<3>().squaredNorm();
    held_m2 += Between(held->estimate.T_a_b, truth).head<3>().squaredNorm();
    EXPECT_LT(error.dot(refined->uncertainty.Omega * error), HotellingLimit(30, 6, 1 - 1e-8)) << seed;
  }
  EXPECT_LT(std::sqrt(refined_m2), 0.6 * std::sqrt(held_m2));
}

}  // namespace
}  // namespace rigcal::calib
