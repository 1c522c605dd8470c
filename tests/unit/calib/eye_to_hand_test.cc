#include "server/calib/eye_to_hand/eye_to_hand.h"

#include <gmock/gmock.h>

#include <cmath>

#include "server/math/covariance.h"
#include "server/math/statistics.h"
#include "tests/unit/calib/virtual_cell.h"

namespace rigcal::calib {
namespace {

using ::testing::HasSubstr;

constexpr PoseNoise kArmNoise{0.0002, 0.0005};

Vector6d ErrorOf(const Se3& truth, const Se3& estimate) { return (truth.Inverse() * estimate).Log(); }

HandEyeProblem Swapped(HandEyeProblem problem) {
  std::swap(problem.a, problem.b);
  if (problem.T_a_b_nominal) problem.T_a_b_nominal = problem.T_a_b_nominal->Inverse();
  return problem;
}

TEST(EyeToHand, IsExactOnExactData) {
  VirtualView view;
  view.sigma_px = 0;
  const VirtualCell cell = Celled(view, Arm::kAll, 12, 1);
  const HandEyeProblem problem = ArmAndCamera(cell, view, {}, true, 1);
  const auto forward = EstimateEyeToHand(problem), backward = EstimateEyeToHand(Swapped(problem));
  ASSERT_TRUE(forward && backward) << forward.error().what;
  EXPECT_LT(ErrorOf(cell.T_base_cam, forward->estimate.T_a_b).norm(), 1e-6);
  EXPECT_LT(ErrorOf(cell.T_base_cam.Inverse(), backward->estimate.T_a_b).norm(), 1e-6);
  EXPECT_LT(ErrorOf(cell.T_flange_board, forward->estimate.T_flange_board).norm(), 1e-6);
  EXPECT_LT(ErrorOf(cell.T_flange_board, backward->estimate.T_flange_board).norm(), 1e-6);
  EXPECT_LT(forward->estimate.all_rms_px, 1e-3);
  EXPECT_EQ(forward->uncertainty.rank, 6);
}

// Of 50 regions of 95 % fewer than 38 cover once in ten million runs.
TEST(EyeToHand, RegionsCoverTheTruth) {
  const VirtualView view;
  int covered = 0, covered_turned = 0, board_near = 0;
  for (unsigned seed = 0; seed < 50; ++seed) {
    const VirtualCell cell = Celled(view, Arm::kAll, 25, seed);
    const HandEyeProblem problem = ArmAndCamera(cell, view, kArmNoise, true, 4000 + seed);
    const auto result = EstimateEyeToHand(problem);
    ASSERT_TRUE(result) << result.error().what;
    ASSERT_EQ(result->uncertainty.rank, 6);
    const double limit = HotellingLimit(result->uncertainty.dof + 1);
    const Vector6d e = ErrorOf(result->estimate.T_a_b, cell.T_base_cam);
    covered += e.dot(result->uncertainty.Omega * e) <= limit ? 1 : 0;
    const auto turned = EstimateEyeToHand(Swapped(problem));
    ASSERT_TRUE(turned);
    const Vector6d back = ErrorOf(turned->estimate.T_a_b, cell.T_base_cam.Inverse());
    covered_turned += back.dot(turned->uncertainty.Omega * back) <= limit ? 1 : 0;
    board_near += ErrorOf(cell.T_flange_board, result->estimate.T_flange_board).head<3>().norm() < 0.002 ? 1 : 0;
  }
  EXPECT_GE(covered, 38);
  EXPECT_GE(covered_turned, 38);
  EXPECT_EQ(board_near, 50);
}

TEST(EyeToHand, LensesThatAreNotGivenAreEstimated) {
  const VirtualView view;
  int covered = 0;
  for (unsigned seed = 0; seed < 12; ++seed) {
    const VirtualCell cell = Celled(view, Arm::kAll, 25, 60 + seed);
    const auto result = EstimateEyeToHand(ArmAndCamera(cell, view, kArmNoise, false, seed));
    ASSERT_TRUE(result) << result.error().what;
    const Vector6d e = ErrorOf(result->estimate.T_a_b, cell.T_base_cam);
    covered += e.dot(result->uncertainty.Omega * e) <= HotellingLimit(result->uncertainty.dof + 1) ? 1 : 0;
    EXPECT_LT(e.head<3>().norm(), 0.01);
  }
  EXPECT_GE(covered, 6);  // of 12 at 95 %: fewer once in three million
}

// e_ba = -Ad(T_ab) e_ab: of the whole, and of each capture left out.
TEST(EyeToHand, DirectionsOfTheEdgeAgree) {
  const VirtualView view;
  const HandEyeProblem problem = ArmAndCamera(Celled(view, Arm::kAll, 20, 21), view, kArmNoise, true, 21);
  const Edge there = EstimateEyeToHandEdge(problem), back = EstimateEyeToHandEdge(Swapped(problem));
  ASSERT_TRUE(there.state == EdgeState::kGood && back.state == EdgeState::kGood);
  EXPECT_LT(ErrorOf(there.T_a_b, back.T_a_b.Inverse()).norm(), 1e-4);
  const Matrix6d reversed = InverseCovariance(there.T_a_b, there.uncertainty.covariance);
  EXPECT_LT((reversed - back.uncertainty.covariance).norm(), 0.1 * reversed.norm());
  ASSERT_EQ(there.uncertainty.blocks.size(), back.uncertainty.blocks.size());
  double apart = 0, size = 0;
  for (std::size_t k = 0; k < back.uncertainty.blocks.size(); ++k) {
    const Vector6d reversed_d = -Adjoint(there.T_a_b) * there.uncertainty.blocks[k].d;
    EXPECT_EQ(there.uncertainty.blocks[k].block_id, back.uncertainty.blocks[k].block_id);
    apart += (reversed_d - back.uncertainty.blocks[k].d).squaredNorm();
    size += reversed_d.squaredNorm();
  }
  EXPECT_LT(apart, 0.05 * size);
  EXPECT_TRUE(Validate(back.uncertainty)) << Sentence(Validate(back.uncertainty).error());
}

// The base's origin is no special place: far from it nothing is lost.
TEST(EyeToHand, AFarOriginOfTheBaseChangesNothing) {
  const VirtualView view;
  const VirtualCell cell = Celled(view, Arm::kAll, 25, 5);
  const HandEyeProblem near = ArmAndCamera(cell, view, kArmNoise, true, 5);
  HandEyeProblem far = near;
  const Se3 T_far_base{{20, -10, 5}, Eigen::Quaterniond::Identity()};
  for (TimedPose& pose : far.a.poses) pose.T_world_body = T_far_base * pose.T_world_body;
  const auto one = EstimateEyeToHand(near), other = EstimateEyeToHand(far);
  ASSERT_TRUE(one && other);
  EXPECT_LT(ErrorOf(T_far_base * one->estimate.T_a_b, other->estimate.T_a_b).norm(), 1e-7);
  EXPECT_LT((one->uncertainty.covariance - other->uncertainty.covariance).norm(),
            1e-4 * one->uncertainty.covariance.norm());
}

TEST(EyeToHand, ResidualsArePixelsOfTheRobotsPoses) {
  VirtualView view;
  view.sigma_px = 0.2;
  const VirtualCell cell = Celled(view, Arm::kAll, 25, 7);
  const Edge quiet = EstimateEyeToHandEdge(ArmAndCamera(cell, view, {}, true, 7));
  ASSERT_EQ(quiet.state, EdgeState::kGood);
  EXPECT_EQ(quiet.method, "eye_to_hand");
  EXPECT_EQ(ResidualUnitOf(quiet.method), "px");
  EXPECT_NEAR(quiet.figures.at("rms_px"), 0.2 * std::sqrt(2.0), 0.03);
  // 2 mm across 1.6 m by a focal length of 1000 px are 1.25 px of either axis.
  const Edge noisy = EstimateEyeToHandEdge(ArmAndCamera(cell, view, {0.002, 0}, true, 8));
  EXPECT_GT(noisy.figures.at("rms_px"), 1.0);
  EXPECT_LT(noisy.figures.at("rms_px"), 3.0);
  ASSERT_EQ(noisy.captures.size(), 25u);
  for (const CaptureResidual& capture : noisy.captures) EXPECT_LT(capture.rms, 8.0);
}

TEST(EyeToHand, TellsWhereTheBoardSitsOnTheFlange) {
  const VirtualView view;
  const VirtualCell cell = Celled(view, Arm::kAll, 25, 9);
  const Edge edge = EstimateEyeToHandEdge(Swapped(ArmAndCamera(cell, view, kArmNoise, true, 9)));
  EXPECT_EQ(edge.frame_a, SensorId("camera"));
  EXPECT_NEAR(edge.figures.at("flange_board_x_m"), cell.T_flange_board.p_m.x(), 0.002);
  EXPECT_NEAR(edge.figures.at("flange_board_z_m"), cell.T_flange_board.p_m.z(), 0.002);
  Se3 told;
  told.q = Se3::Exp((Vector6d() << 0, 0, 0, edge.figures.at("flange_board_rx_rad"),
                     edge.figures.at("flange_board_ry_rad"), edge.figures.at("flange_board_rz_rad"))
                        .finished())
               .q;
  EXPECT_LT(told.q.angularDistance(cell.T_flange_board.q), 0.003);
}

struct Poor {
  Arm arm;
  int rank;
  const char* code;
};
class PoorMotion : public testing::TestWithParam<Poor> {};

// Six sigma of five numbers with 24 degrees of freedom: once in 60,000 seeds; the seeds are fixed.
TEST_P(PoorMotion, ClaimsOnlyWhatItKnows) {
  const VirtualView view;
  for (unsigned seed = 0; seed < 5; ++seed) {
    const VirtualCell cell = Celled(view, GetParam().arm, 25, 30 + seed);
    HandEyeProblem problem = ArmAndCamera(cell, view, kArmNoise, true, 90 + seed);
    problem.T_a_b_nominal = cell.T_base_cam * Se3::Exp(0.002 * Vector6d::Ones());
    const Edge edge = EstimateEyeToHandEdge(problem);
    ASSERT_EQ(edge.state, EdgeState::kGood) << edge.diagnoses.front().what;
    EXPECT_EQ(edge.uncertainty.rank, GetParam().rank);
    ASSERT_FALSE(edge.diagnoses.empty());
    EXPECT_EQ(edge.diagnoses.front().code, GetParam().code);
    EXPECT_THAT(edge.diagnoses.front().cure, HasSubstr("Turn the flange"));
    EXPECT_LT(WorstSigmas(cell.T_base_cam, edge.T_a_b, edge.uncertainty), 6.0);
    if (GetParam().rank != 5 && GetParam().rank != 4) continue;
    EXPECT_THAT(edge.diagnoses.front().what, HasSubstr("in the frame of arm"));
    EXPECT_GT(std::abs(edge.figures.at("axis_a_z_ratio")), 0.999);
  }
}

INSTANTIATE_TEST_SUITE_P(All, PoorMotion,
                         testing::Values(Poor{Arm::kOneAxis, 5, "planar_motion"},
                                         Poor{Arm::kFirstJoint, 4, "turning_on_the_spot"},
                                         Poor{Arm::kNoTurns, 3, "pure_translation"}));

TEST(EyeToHand, RefusesABoardThatStandsStill) {
  const VirtualView view;
  HandEyeProblem problem = TrackerAndCamera(Looking(view, 20, 0.25, 0.2, 3), view, kArmNoise, 0, 3);
  problem.method = Method::kEyeToHand;
  const Edge edge = EstimateEyeToHandEdge(problem);
  ASSERT_EQ(edge.state, EdgeState::kFailed);
  EXPECT_EQ(edge.diagnoses.front().code, "board_stands_still");
  EXPECT_THAT(edge.diagnoses.front().cure, HasSubstr("leave 'mounted_on' of target 'board' away"));
}

TEST(TrackerCamera, RefusesABoardOnTheFlange) {
  const VirtualView view;
  const VirtualCell cell = Celled(view, Arm::kAll, 20, 11);
  HandEyeProblem problem = ArmAndCamera(cell, view, kArmNoise, true, 11);
  problem.method = Method::kTrackerCamera;
  problem.b.board->mounted_on.reset();
  const Edge edge = EstimateTrackerCameraEdge(problem);
  ASSERT_EQ(edge.state, EdgeState::kFailed);
  EXPECT_EQ(edge.method, "tracker_camera");
  EXPECT_EQ(edge.diagnoses.front().code, "board_on_flange");
  EXPECT_THAT(edge.diagnoses.front().cure, HasSubstr("say 'mounted_on: arm' of target 'board'"));
}

TEST(TrackerCamera, IsOtherwiseAsHandEyeSaysIt) {
  const VirtualView view;
  const HandEyeProblem problem = TrackerAndCamera(Looking(view, 20, 0.25, 0.2, 3), view, kArmNoise, 0, 3);
  const Edge one = EstimateTrackerCameraEdge(problem), other = EstimateHandEyeEdge(problem);
  ASSERT_EQ(one.state, EdgeState::kGood);
  EXPECT_EQ(one.T_a_b.p_m, other.T_a_b.p_m);
  EXPECT_EQ(one.figures, other.figures);
}

TEST(EyeToHand, ASmallerBoardThanGivenIsNamed) {
  VirtualView view;
  const VirtualCell cell = Celled(view, Arm::kAll, 25, 13);
  HandEyeProblem problem = ArmAndCamera(cell, view, kArmNoise, true, 13);
  problem.b.board->square_m *= 1.05;
  const Edge edge = EstimateEyeToHandEdge(problem);
  ASSERT_EQ(edge.state, EdgeState::kFailed);
  EXPECT_EQ(edge.diagnoses.front().code, "board_size_suspected");
}

TEST(EyeToHand, OneSwappedPictureIsLeftOut) {
  const VirtualView view;
  HandEyeProblem problem = ArmAndCamera(Celled(view, Arm::kAll, 20, 15), view, kArmNoise, true, 15);
  std::swap(problem.b.views[3].second, problem.b.views[11].second);
  const Edge edge = EstimateEyeToHandEdge(problem);
  ASSERT_EQ(edge.state, EdgeState::kGood);
  EXPECT_FALSE(edge.captures[3].used);
  EXPECT_FALSE(edge.captures[11].used);
  EXPECT_EQ(edge.figures.at("captures_used"), 18);
}

TEST(EyeToHand, TooFewCapturesSayWhatToTake) {
  const VirtualView view;
  const Edge edge = EstimateEyeToHandEdge(ArmAndCamera(Celled(view, Arm::kAll, 3, 17), view, kArmNoise, true, 17));
  ASSERT_EQ(edge.state, EdgeState::kFailed);
  EXPECT_EQ(edge.diagnoses.front().code, "too_few_captures");
  EXPECT_THAT(edge.diagnoses.front().cure, HasSubstr("the flange in different places"));
}

}  // namespace
}  // namespace rigcal::calib
