// Boards that are bent: the virtual robot bends its plates as a cylinder or a saddle, and shares no code with the
// refinement.
#include <gmock/gmock.h>

#include <cmath>

#include "server/calib/joint/problem/board_bend.h"
#include "tests/unit/calib/joint/visit.h"

namespace rigcal::calib::joint {
namespace {

sim::Options WithBend(std::uint64_t seed, double height_m) {
  sim::Options options = WithSeed(seed);
  options.disturb.board_bend_m = height_m;
  return options;
}

TEST(JointBend, OfABoardIsTakenOutAndTold) {
  const FeatureSession session = Visit(WithBend(31, 5e-4));
  const SessionEstimate estimate = EstimateFrom(session);
  EXPECT_LT(WorstT2(session, estimate), 40.0);  // 6 are expected
  ASSERT_FALSE(estimate.bends.empty());
  for (const BoardBend& bend : estimate.bends) {
    // A cylinder is 0.5 mm from its axis to a corner of the plate, a saddle up to twice that.
    EXPECT_GT(bend.height_m, 2e-4 - 4 * bend.sigma_m) << bend.board.str();
    EXPECT_LT(bend.height_m, 1e-3 + 4 * bend.sigma_m) << bend.board.str();
    EXPECT_LT(bend.sigma_m, 1e-4);
  }
}

TEST(JointBend, IsNotToldOfFlatBoards) {
  for (const std::uint64_t seed : {32, 33})
    EXPECT_THAT(EstimateFrom(Visit(WithBend(seed, 0.0))).bends, testing::IsEmpty()) << "seed " << seed;
}

// By quadrature over the plate: what a lidar sees of it is its plane.
TEST(JointBend, LeavesTheMeanPlane) {
  Target target;
  target.cols = 7, target.rows = 5, target.square_m = 0.05;
  target.plate_m = Eigen::Vector2d(0.5, 0.4);
  Eigen::Matrix3d moments = Eigen::Matrix3d::Zero();  // of each shape: with 1, x and y
  for (double x = -0.2495; x < 0.25; x += 0.001)
    for (double y = -0.1995; y < 0.2; y += 0.001)
      moments += BendShape(target, CentreOf(target) + Eigen::Vector3d(x, y, 0)) * Eigen::RowVector3d(1, x, y);
  EXPECT_LT((moments / (500 * 400)).cwiseAbs().maxCoeff(), 1e-5);
}

}  // namespace
}  // namespace rigcal::calib::joint
