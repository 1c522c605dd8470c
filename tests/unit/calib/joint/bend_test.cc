// Boards that are bent: the virtual robot bends its plates as a cylinder or a saddle, and shares no code with the
// refinement.
#include <gmock/gmock.h>

#include <cmath>

#include "server/calib/joint/misfit/board_or_lens.h"
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

// Lenses that are estimated from the bent board itself may be what bends it.
TEST(JointBend, IsNotTheBoardsWhereLensesAreEstimated) {
  sim::Options options = WithBend(31, 5e-4);
  options.intrinsics = sim::IntrinsicsKind::kAbsent;
  for (const BoardBend& bend : EstimateFrom(Visit(options)).bends) {
    EXPECT_FALSE(bend.is_the_board) << bend.board.str();
    EXPECT_FALSE(bend.seen_by.empty());
  }
}

TEST(JointBend, OfALensIsNotTheBoards) {
  for (const std::uint64_t seed : {34, 35}) {
    sim::Options options = WithSeed(seed);
    options.disturb.lens_misfit_px = 0.1;
    for (const BoardBend& bend : EstimateFrom(Visit(options)).bends)
      EXPECT_FALSE(bend.is_the_board) << bend.board.str() << " seed " << seed;
  }
}

constexpr double kBent_m = 5e-4;

// Of boards of one size, each look to a sigma of a tenth of the bend.
BendsSeen Seen(std::vector<BendSeen> looks, std::vector<bool> lens_known) {
  const auto rows = static_cast<Eigen::Index>(3 * looks.size());
  return {std::move(looks),
          Eigen::MatrixXd::Identity(rows, rows) * 0.01 * kBent_m * kBent_m,
          std::move(lens_known),
          {0.5, 0.5}};
}
BendSeen Look(int target, int camera, double times) { return {target, camera, {times * kBent_m, 0.0, 0.0}}; }

TEST(BoardOrLens, TwoKnownLensesThatAgreeNameTheBoard) {
  EXPECT_TRUE(IsTheBoard(Seen({Look(0, 0, 1.0), Look(0, 1, 0.9)}, {true, true}), 0));
  EXPECT_FALSE(IsTheBoard(Seen({Look(0, 0, 1.0)}, {true, true}), 0)) << "one camera";
  EXPECT_FALSE(IsTheBoard(Seen({Look(0, 0, 1.0), Look(0, 1, 0.9)}, {true, false}), 0)) << "one lens is estimated";
  EXPECT_FALSE(IsTheBoard(Seen({Look(0, 0, 1.0), Look(0, 1, -1.0)}, {true, true}), 0))
      << "they see it bent the other way";
  EXPECT_FALSE(IsTheBoard(Seen({Look(0, 0, 1.0), Look(0, 1, 0.2)}, {true, true}), 0)) << "one sees it flat";
  EXPECT_FALSE(IsTheBoard(Seen({Look(0, 0, 1.0), Look(0, 1, 0.9)}, {true, true}), 1)) << "that is another board";
}

TEST(BoardOrLens, AFlatBoardBesideABentOneClearsTheLens) {
  EXPECT_TRUE(IsTheBoard(Seen({Look(0, 0, 1.0), Look(1, 0, 0.1)}, {false}), 0));
  EXPECT_FALSE(IsTheBoard(Seen({Look(0, 0, 1.0), Look(1, 0, 0.1)}, {false}), 1)) << "the flat one";
  EXPECT_FALSE(IsTheBoard(Seen({Look(0, 0, 1.0), Look(1, 0, 1.0)}, {false}), 0)) << "all are bent alike";
  EXPECT_FALSE(IsTheBoard(Seen({Look(0, 0, 1.0), Look(1, 1, 0.1)}, {false, false}), 0))
      << "another lens saw the flat one";
  BendsSeen vague = Seen({Look(0, 0, 1.0), Look(1, 0, 0.1)}, {false});
  vague.C_m2.bottomRightCorner<3, 3>() *= 100;
  EXPECT_FALSE(IsTheBoard(vague, 0)) << "nobody knows how flat the other is";
  BendsSeen small = Seen({Look(0, 0, 1.0), Look(1, 0, 0.1)}, {false});
  small.half_diagonal_m[1] = 0.15;  // as curved as the large one, it would be bent by 0.09 of its bend
  EXPECT_FALSE(IsTheBoard(small, 0)) << "too small to show it";
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
