#include <gmock/gmock.h>

#include <cmath>
#include <map>
#include <random>

#include "server/math/covariance.h"
#include "tests/unit/calib/virtual_lidar.h"

namespace rigcal::calib {
namespace {

using testing::HasSubstr;

Vector6d ErrorOf(const Se3& truth, const Se3& estimate) { return (truth.Inverse() * estimate).Log(); }

std::string CodeOf(const Edge& edge) { return edge.diagnoses.empty() ? "" : edge.diagnoses.front().code; }

bool HasNote(const Edge& edge, const std::string& code) {
  return std::any_of(edge.diagnoses.begin(), edge.diagnoses.end(), [&](const Diagnosis& d) { return d.code == code; });
}

VirtualLidarRig NoisyRig() {
  VirtualLidarRig rig;
  rig.corner_sigma_px = 0.2;
  rig.range_sigma_m = 0.02;
  return rig;
}

TEST(LidarCamera, ExactDataGiveTheTruth) {
  VirtualLidarRig rig;
  rig.decoys = true;
  const auto estimate = EstimateLidarCamera(Recorded(rig, BoardsBefore(12), 1), nullptr, nullptr);
  ASSERT_TRUE(estimate) << estimate.error().what;
  EXPECT_LT(ErrorOf(rig.T_cam_lidar, estimate->T_cam_lidar).norm(), 1e-5);  // points are floats
  EXPECT_EQ(estimate->patch_idx.size(), 12u);
  for (const auto& [capture, idx] : estimate->patch_idx) EXPECT_EQ(idx, 3u) << capture.str();
}

TEST(LidarCamera, ANoisyAnswerLiesWithinItsSigma) {
  const VirtualLidarRig rig = NoisyRig();
  const Edge edge = EstimateLidarCameraEdge(Recorded(rig, BoardsBefore(20), 2));
  ASSERT_EQ(edge.state, EdgeState::kGood) << edge.diagnoses.front().what;
  EXPECT_EQ(edge.method, "lidar_camera");
  EXPECT_EQ(edge.uncertainty.source, UncertaintySource::kJackknife);
  EXPECT_EQ(edge.uncertainty.blocks.size(), 20u);
  const Vector6d error = ErrorOf(rig.T_cam_lidar, edge.T_a_b);
  const Vector6d sigma = edge.uncertainty.covariance.diagonal().cwiseSqrt();
  for (int axis = 0; axis < 6; ++axis) EXPECT_LT(std::abs(error[axis]), 5 * sigma[axis]) << axis;
  EXPECT_LT(sigma.head<3>().maxCoeff(), 0.01);
  EXPECT_NEAR(edge.figures.at("range_sigma_m"), 0.02, 0.002);
  EXPECT_FALSE(HasNote(edge, "range_bias_suspected"));
}

// Mean of the squared errors over the squared sigmas: 1 if sigma is honest. 40 seeds of 6 numbers each scatter it by
// 0.1.
TEST(LidarCamera, SigmaIsTheScatterOverSeeds) {
  const VirtualLidarRig rig = NoisyRig();
  double sum = 0;
  constexpr int kSeeds = 40;
  for (unsigned seed = 0; seed < kSeeds; ++seed) {
    const Edge edge = EstimateLidarCameraEdge(Recorded(rig, BoardsBefore(16), 100 + seed));
    ASSERT_EQ(edge.state, EdgeState::kGood);
    const Vector6d error = ErrorOf(rig.T_cam_lidar, edge.T_a_b);
    sum += (error.array().square() / edge.uncertainty.covariance.diagonal().array()).mean() / kSeeds;
  }
  RecordProperty("mean_squared_ratio", std::to_string(sum));
  EXPECT_GT(sum, 0.4);
  EXPECT_LT(sum, 1.8);
}

// As above, of intrinsics that were given loosely: then most of the scatter comes from the corners by way of them.
double MeanSquaredRatioOfRefined(int captures, int seeds) {
  VirtualLidarRig rig = NoisyRig();
  rig.range_sigma_m = 0.002;
  const std::vector<double> sigma = {20, 20, 20, 20, 0.02, 0.02, 0.02, 0.02};
  double sum = 0;
  for (int seed = 0; seed < seeds; ++seed) {
    LidarCameraProblem problem = Recorded(rig, BoardsBefore(captures), static_cast<unsigned>(300 + seed));
    std::mt19937 random(static_cast<unsigned>(700 + seed));
    std::normal_distribution<double> normal;
    IntrinsicsVector given = VectorOf(rig.intrinsics);
    for (std::size_t i = 0; i < sigma.size(); ++i) given[static_cast<Eigen::Index>(i)] += sigma[i] * normal(random);
    problem.camera.intrinsics = IntrinsicsOf(rig.intrinsics.model, given);
    problem.camera.intrinsics_sigma = sigma;
    const Edge edge = EstimateLidarCameraEdge(problem);
    if (edge.state != EdgeState::kGood) return std::nan("");
    const Vector6d error = ErrorOf(rig.T_cam_lidar, edge.T_a_b);
    sum += (error.array().square() / edge.uncertainty.covariance.diagonal().array()).mean() / seeds;
  }
  return sum;
}

// Few clouds beside many pictures: the clouds' jackknife does not tell what the intrinsics are worth.
TEST(LidarCamera, SigmaIsTheScatterWhereIntrinsicsAreEstimated) {
  VirtualLidarRig rig = NoisyRig();
  rig.range_sigma_m = 0.002;
  constexpr int kSeeds = 40;
  double sum = 0;
  for (unsigned seed = 0; seed < kSeeds; ++seed) {
    LidarCameraProblem problem = Recorded(rig, BoardsBefore(12), 500 + seed);
    problem.camera.intrinsics.reset();
    for (std::size_t k = 4; k < problem.captures.size(); ++k) problem.captures[k].cloud.reset();
    const Edge edge = EstimateLidarCameraEdge(problem);
    ASSERT_EQ(edge.state, EdgeState::kGood) << edge.diagnoses.front().what;
    const Vector6d error = ErrorOf(rig.T_cam_lidar, edge.T_a_b);
    sum += (error.array().square() / edge.uncertainty.covariance.diagonal().array()).mean() / kSeeds;
  }
  RecordProperty("mean_squared_ratio", std::to_string(sum));
  EXPECT_GT(sum, 0.4);
  EXPECT_LT(sum, 1.8);
}

TEST(LidarCamera, SigmaIsTheScatterWhereIntrinsicsAreRefined) {
  for (const int captures : {4, 6, 12}) {
    const double ratio = MeanSquaredRatioOfRefined(captures, 40);
    RecordProperty("mean_squared_ratio_" + std::to_string(captures), std::to_string(ratio));
    EXPECT_GT(ratio, 0.3) << captures;  // few captures are told carefully: never below the model
    EXPECT_LT(ratio, 1.8) << captures;
  }
}

TEST(LidarCamera, TheLidarMayComeFirst) {
  LidarCameraProblem problem = Recorded(NoisyRig(), BoardsBefore(12), 3);
  const Edge forward = EstimateLidarCameraEdge(problem);
  problem.camera_is_a = false;
  const Edge backward = EstimateLidarCameraEdge(problem);
  EXPECT_EQ(backward.frame_a, SensorId("top"));
  EXPECT_EQ(backward.frame_b, SensorId("front"));
  EXPECT_LT((forward.T_a_b * backward.T_a_b).Log().norm(), 1e-9);
  const Matrix6d expected = InverseCovariance(forward.T_a_b, forward.uncertainty.covariance);
  EXPECT_LT((backward.uncertainty.covariance - expected).norm(), 0.02 * expected.norm());
}

TEST(LidarCamera, TheStartDoesNotShow) {
  VirtualLidarRig rig = NoisyRig();
  rig.decoys = true;
  LidarCameraProblem problem = Recorded(rig, BoardsBefore(15), 4);
  const auto without = EstimateLidarCamera(problem, nullptr, nullptr);
  problem.T_cam_lidar_nominal = rig.T_cam_lidar * Se3::Exp((Vector6d() << 0.12, -0.12, 0.1, 0.1, 0.1, -0.1).finished());
  const auto with = EstimateLidarCamera(problem, nullptr, nullptr);
  ASSERT_TRUE(without && with);
  EXPECT_LT(ErrorOf(without->T_cam_lidar, with->T_cam_lidar).norm(), 1e-7);
}

TEST(LidarCamera, EstimatesTheIntrinsicsToo) {
  const VirtualLidarRig rig = NoisyRig();
  LidarCameraProblem problem = Recorded(rig, BoardsBefore(40), 5);
  problem.camera.intrinsics.reset();
  const Edge edge = EstimateLidarCameraEdge(problem);
  ASSERT_EQ(edge.state, EdgeState::kGood) << edge.diagnoses.front().what;
  EXPECT_NEAR(edge.figures.at("fx_px"), rig.intrinsics.fx_px, 6);
  const Vector6d error = ErrorOf(rig.T_cam_lidar, edge.T_a_b);
  const Vector6d sigma = edge.uncertainty.covariance.diagonal().cwiseSqrt();
  for (int axis = 0; axis < 6; ++axis) EXPECT_LT(std::abs(error[axis]), 5 * sigma[axis]) << axis;
}

TEST(LidarCamera, SuspectsARangeBiasAndPutsItIntoSigma) {
  VirtualLidarRig rig = NoisyRig();
  rig.range_bias_m = 0.03;  // ranges come out 30 mm too short
  const Edge edge = EstimateLidarCameraEdge(Recorded(rig, BoardsBefore(50), 6));
  ASSERT_EQ(edge.state, EdgeState::kGood);
  EXPECT_TRUE(HasNote(edge, "range_bias_suspected"));
  EXPECT_NEAR(edge.figures.at("range_bias_m"), 0.03, 4 * edge.figures.at("range_bias_sigma_m"));
  ASSERT_FALSE(edge.uncertainty.contributions.empty());
  EXPECT_THAT(edge.uncertainty.contributions.back().name, HasSubstr("range bias of top"));
  const Vector6d error = ErrorOf(rig.T_cam_lidar, edge.T_a_b);
  const Vector6d sigma = edge.uncertainty.covariance.diagonal().cwiseSqrt();
  for (int axis = 0; axis < 6; ++axis) EXPECT_LT(std::abs(error[axis]), 5 * sigma[axis]) << axis;
}

// Boards straight ahead: a bias of the ranges moves the lidar along its view and hardly shows in the residuals.
TEST(LidarCamera, AGivenRangeBiasSigmaCoversABiasThatCannotBeSeen) {
  VirtualLidarRig rig = NoisyRig();
  rig.range_bias_m = 0.02;
  LidarCameraProblem problem = Recorded(rig, BoardsBefore(12), 15);
  const Edge without = EstimateLidarCameraEdge(problem);
  problem.lidar.range_bias_sigma_m = 0.02;
  const Edge with = EstimateLidarCameraEdge(problem);
  ASSERT_EQ(without.state, EdgeState::kGood);
  ASSERT_EQ(with.state, EdgeState::kGood);
  EXPECT_TRUE(HasNote(without, "range_taken_as_exact"));
  EXPECT_FALSE(HasNote(with, "range_taken_as_exact"));
  EXPECT_LT((without.T_a_b.Inverse() * with.T_a_b).Log().norm(), 1e-12);
  const double error_m = std::abs(ErrorOf(rig.T_cam_lidar, with.T_a_b)[0]);
  EXPECT_GT(error_m, 5 * std::sqrt(without.uncertainty.covariance(0, 0)));
  EXPECT_LT(error_m, 3 * std::sqrt(with.uncertainty.covariance(0, 0)));
}

// Every beam is off by a constant of its own: that tilts and moves the board alike in all captures, so that no
// jackknife sees it. A bias that all beams share does not cover it: with that alone the mean is 22.
TEST(LidarCamera, AGivenRangeBiasSigmaCoversBeamsThatErrEachByItself) {
  constexpr unsigned kSeeds = 20;
  constexpr double kBias_m = 0.02, kBeam_rad = 1.5 * M_PI / 180;
  double squares = 0;
  for (unsigned seed = 0; seed < kSeeds; ++seed) {
    const VirtualLidarRig rig = NoisyRig();
    std::vector<Se3> boards = BoardsBefore(24);
    for (Se3& board : boards) board.p_m = boards.front().p_m;  // each beam meets it at the same place in all captures
    LidarCameraProblem problem = Recorded(rig, boards, 700 + seed);
    problem.lidar.range_bias_sigma_m = kBias_m;
    std::mt19937 random(seed);
    std::normal_distribution<double> normal(0, kBias_m);
    std::map<int, double> bias_m;
    for (int beam = -60; beam < 60; ++beam) bias_m[beam] = normal(random);
    for (LidarCameraCapture& capture : problem.captures)
      for (PlanePatch& patch : capture.cloud->candidates)
        for (Eigen::Vector3f& p : patch.points_m) {
          const double elevation_rad = std::atan2(p.z(), std::hypot(p.x(), p.y()));
          p += static_cast<float>(bias_m[static_cast<int>(std::floor(elevation_rad / kBeam_rad))]) * p.normalized();
        }
    const Edge edge = EstimateLidarCameraEdge(problem);
    ASSERT_EQ(edge.state, EdgeState::kGood) << edge.diagnoses.front().what;
    const Vector6d error = ErrorOf(rig.T_cam_lidar, edge.T_a_b);
    squares += error.dot(edge.uncertainty.Omega * error) / 6 / kSeeds;
  }
  RecordProperty("mean_squared_ratio", std::to_string(squares));
  EXPECT_GT(squares, 0.2);
  EXPECT_LT(squares, 2.0);
}

TEST(LidarCamera, LeavesOutACloudOfAnotherMoment) {
  const VirtualLidarRig rig = NoisyRig();
  const std::vector<Se3> boards = BoardsBefore(14);
  LidarCameraProblem problem = Recorded(rig, boards, 7);
  for (PlanePatch& patch : problem.captures[5].cloud->candidates)  // the board moved back by 12 cm
    for (Eigen::Vector3f& p : patch.points_m) p += 0.12f * p.normalized();
  const Edge edge = EstimateLidarCameraEdge(problem);
  ASSERT_EQ(edge.state, EdgeState::kGood);
  EXPECT_TRUE(HasNote(edge, "inconsistent_captures"));
  EXPECT_FALSE(edge.captures[5].used);
  EXPECT_THAT(edge.captures[5].note, HasSubstr("contradicts its picture"));
  EXPECT_LT(ErrorOf(rig.T_cam_lidar, edge.T_a_b).head<3>().norm(), 0.02);
}

TEST(LidarCameraDiagnosis, TooFewCaptures) {
  LidarCameraProblem problem = Recorded(NoisyRig(), BoardsBefore(8), 8);
  for (std::size_t i = 3; i < 8; ++i)
    problem.captures[i].cloud->found = false, problem.captures[i].cloud->candidates.clear();
  const Edge edge = EstimateLidarCameraEdge(problem);
  EXPECT_EQ(edge.state, EdgeState::kFailed);
  EXPECT_EQ(CodeOf(edge), "too_few_captures");
  EXPECT_TRUE(HasNote(edge, "board_not_found_in_cloud"));
}

TEST(LidarCameraDiagnosis, WhatCannotBeReadIsNamedApart) {
  LidarCameraProblem problem = Recorded(NoisyRig(), BoardsBefore(8), 8);
  problem.captures[2].cloud = CloudView();
  problem.captures[4].view = BoardView();
  const Edge edge = EstimateLidarCameraEdge(problem);
  EXPECT_TRUE(HasNote(edge, "cloud_unreadable"));
  EXPECT_TRUE(HasNote(edge, "picture_unreadable"));
  EXPECT_FALSE(HasNote(edge, "board_not_found"));
  EXPECT_FALSE(HasNote(edge, "board_not_found_in_cloud"));
}

TEST(LidarCameraDiagnosis, AFailedEdgeCountsWhatItsFilesHold) {
  LidarCameraProblem problem = Recorded(NoisyRig(), BoardsBefore(8), 8);
  for (std::size_t i = 0; i < 4; ++i) problem.captures[i].view.reset();
  for (std::size_t i = 5; i < 8; ++i) problem.captures[i].cloud = CloudView();
  const Edge edge = EstimateLidarCameraEdge(problem);
  ASSERT_EQ(CodeOf(edge), "too_few_captures");
  EXPECT_EQ(edge.figures.at("files_a"), 4);
  EXPECT_EQ(edge.figures.at("files_with_board_a"), 4);
  EXPECT_EQ(edge.figures.at("files_b"), 8);
  EXPECT_EQ(edge.figures.at("files_with_board_b"), 5);
  EXPECT_EQ(edge.figures.at("files_unreadable_b"), 3);
  EXPECT_EQ(edge.figures.at("first_unreadable_b_idx"), 5);
}

TEST(LidarCameraDiagnosis, NoSpreadOfNormals) {
  std::vector<Se3> boards = BoardsBefore(12);
  for (Se3& board : boards) board.q.setIdentity();
  const Edge edge = EstimateLidarCameraEdge(Recorded(NoisyRig(), boards, 9));
  EXPECT_EQ(edge.state, EdgeState::kFailed);
  EXPECT_EQ(CodeOf(edge), "no_normal_spread");
}

TEST(LidarCameraDiagnosis, CloudsOfAnotherVisitAgreeOnNothing) {
  const VirtualLidarRig rig = NoisyRig();
  LidarCameraProblem problem = Recorded(rig, BoardsBefore(10), 11);
  const LidarCameraProblem other = Recorded(rig, BoardsBefore(40), 12);
  for (std::size_t i = 0; i < 10; ++i) problem.captures[i].cloud = other.captures[39 - (i * 3)].cloud;
  EXPECT_EQ(CodeOf(EstimateLidarCameraEdge(problem)), "no_agreement");
}

// A second board of the same kind, fixed to the first: both explain every picture.
TEST(LidarCameraDiagnosis, TwoBoardsThatMoveTogetherAreAmbiguousUntilNominalPosesSettleIt) {
  const VirtualLidarRig rig = NoisyRig();
  LidarCameraProblem problem = Recorded(rig, BoardsBefore(12), 13);
  const Se3 shift = Se3::Exp((Vector6d() << 0.1, 1.2, 0.2, 0.1, 0.3, 0.8).finished());
  for (LidarCameraCapture& capture : problem.captures) {
    PlanePatch twin = capture.cloud->candidates.front();
    twin.centre_m = shift * twin.centre_m;
    twin.normal = shift.q * twin.normal;
    for (Eigen::Vector3f& p : twin.points_m) p = (shift * Eigen::Vector3d(p.cast<double>())).cast<float>();
    capture.cloud->candidates.push_back(twin);
  }
  EXPECT_EQ(CodeOf(EstimateLidarCameraEdge(problem)), "ambiguous_board");
  problem.T_cam_lidar_nominal = rig.T_cam_lidar * Se3::Exp((Vector6d() << 0, 0, 0, 0, 0, 1.6).finished());
  EXPECT_EQ(CodeOf(EstimateLidarCameraEdge(problem)), "ambiguous_board");  // too far off to settle anything
  problem.T_cam_lidar_nominal = rig.T_cam_lidar * Se3::Exp((Vector6d() << 0.1, 0.1, 0, 0, 0.1, 0).finished());
  const Edge edge = EstimateLidarCameraEdge(problem);
  ASSERT_EQ(edge.state, EdgeState::kGood);
  EXPECT_LT(ErrorOf(rig.T_cam_lidar, edge.T_a_b).head<3>().norm(), 0.02);
}

TEST(LidarCameraDiagnosis, AWrongSquareSizeIsNamedWithTheRightOne) {
  LidarCameraProblem problem = Recorded(NoisyRig(), BoardsBefore(20), 14);
  problem.board.square_m = 0.105;  // it is 0.1
  const Edge edge = EstimateLidarCameraEdge(problem);
  EXPECT_EQ(edge.state, EdgeState::kFailed);
  ASSERT_EQ(CodeOf(edge), "board_size_suspected");
  EXPECT_THAT(edge.diagnoses.front().what, HasSubstr("instead of 105.00 mm"));
  EXPECT_EQ(edge.figures.at("board_square_m"), 0.105);
  EXPECT_NEAR(edge.figures.at("board_scale_ratio"), 0.1 / 0.105 - 1, 4 * edge.figures.at("board_scale_sigma_ratio"));
}

TEST(LidarCamera, ASmallErrorOfTheSquareIsNotedAndPutIntoSigma) {
  const VirtualLidarRig rig = NoisyRig();
  LidarCameraProblem problem = Recorded(rig, BoardsBefore(40), 16);
  problem.board.square_m *= 1.01;
  const Edge edge = EstimateLidarCameraEdge(problem);
  ASSERT_EQ(edge.state, EdgeState::kGood);
  EXPECT_TRUE(HasNote(edge, "board_size_suspected"));
  EXPECT_NEAR(edge.figures.at("board_scale_ratio"), 1 / 1.01 - 1, 4 * edge.figures.at("board_scale_sigma_ratio"));
  const Vector6d error = ErrorOf(rig.T_cam_lidar, edge.T_a_b);
  const Vector6d sigma = edge.uncertainty.covariance.diagonal().cwiseSqrt();
  for (int axis = 0; axis < 6; ++axis) EXPECT_LT(std::abs(error[axis]), 5 * sigma[axis]) << axis;
}

TEST(LidarCamera, ARepeatedCaptureIsNoEvidence) {
  LidarCameraProblem problem = Recorded(NoisyRig(), BoardsBefore(12), 17);
  const Edge once = EstimateLidarCameraEdge(problem);
  for (std::size_t i = 0; i < 12; ++i) {
    problem.captures.push_back(problem.captures[i]);
    problem.captures.back().capture = CaptureId("copy" + std::to_string(i));
  }
  const Edge twice = EstimateLidarCameraEdge(problem);
  ASSERT_EQ(twice.state, EdgeState::kGood);
  EXPECT_EQ(twice.uncertainty.blocks.size(), 12u);
  EXPECT_LT((once.uncertainty.covariance - twice.uncertainty.covariance).norm(),
            1e-6 * once.uncertainty.covariance.norm());
}

TEST(LidarCamera, ExchangedCloudsAreNamed) {
  LidarCameraProblem problem = Recorded(NoisyRig(), BoardsBefore(16), 18);
  std::swap(problem.captures[4].cloud, problem.captures[11].cloud);
  const Edge edge = EstimateLidarCameraEdge(problem);
  ASSERT_EQ(edge.state, EdgeState::kGood);
  EXPECT_TRUE(HasNote(edge, "captures_disagree") || HasNote(edge, "inconsistent_captures"));
}

TEST(LidarCameraDiagnosis, AFewThatAgreeByChanceAreNoAgreement) {
  LidarCameraProblem problem = Recorded(NoisyRig(), BoardsBefore(20), 19);
  for (std::size_t i = 0; i < 7; ++i) std::swap(problem.captures[2 * i].cloud, problem.captures[19 - 2 * i].cloud);
  EXPECT_EQ(CodeOf(EstimateLidarCameraEdge(problem)), "no_agreement");
}

TEST(LidarCameraDiagnosis, IntrinsicsNeedMorePictures) {
  LidarCameraProblem problem = Recorded(NoisyRig(), BoardsBefore(6), 20);
  problem.camera.intrinsics.reset();
  EXPECT_THAT(CodeOf(EstimateLidarCameraEdge(problem)), testing::AnyOf("too_few_captures", "no_tilt"));
}

}  // namespace
}  // namespace rigcal::calib
