// Boards whose print is stretched: the virtual robot stretches what is printed along the columns of its boards, and
// shares no code with the refinement.
#include <gmock/gmock.h>

#include "tests/unit/calib/joint/visit.h"

namespace rigcal::calib::joint {
namespace {

sim::Options WithStretch(std::uint64_t seed, double ratio) {
  sim::Options options = WithSeed(seed);
  options.disturb.board_stretch_ratio = ratio;
  return options;
}

TEST(PrintStrain, IsTakenOutAndTold) {
  for (const double ratio : {0.0003, 0.003}) {
    const FeatureSession session = Visit(WithStretch(31, ratio));
    const SessionEstimate estimate = EstimateFrom(session);
    EXPECT_LT(WorstT2(session, estimate), 30.0) << ratio;  // 6 are expected; hundreds where it stays in
    EXPECT_THAT(estimate.moved, testing::IsEmpty()) << ratio;
    ASSERT_FALSE(estimate.stretches.empty()) << ratio;
    for (const PrintStretch& stretch : estimate.stretches) {
      EXPECT_NEAR(stretch.longer_ratio, ratio, 4 * stretch.sigma_ratio) << stretch.board.str();
      EXPECT_LT(stretch.sigma_ratio, 1e-4) << stretch.board.str();
      EXPECT_GT(stretch.corners_along, 0) << stretch.board.str();
      EXPECT_FALSE(stretch.seen_by.empty());
    }
  }
}

TEST(PrintStrain, IsTakenOutWhereLensesAreEstimated) {
  sim::Options options = WithStretch(31, 0.001);
  options.intrinsics = sim::IntrinsicsKind::kAbsent;
  const FeatureSession session = Visit(options);
  const SessionEstimate estimate = EstimateFrom(session);
  EXPECT_LT(WorstT2(session, estimate), 30.0);
  EXPECT_FALSE(estimate.stretches.empty());
}

TEST(PrintStrain, IsNotToldOfGoodPrints) {
  for (const std::uint64_t seed : {32, 33})
    EXPECT_THAT(EstimateFrom(Visit(WithSeed(seed))).stretches, testing::IsEmpty()) << "seed " << seed;
}

TEST(PrintStrain, IsNotToldOfBoardsOfAnotherSize) {
  sim::Options options = WithSeed(34);
  options.board_scale_ratio = 1.003;
  EXPECT_THAT(EstimateFrom(Visit(options)).stretches, testing::IsEmpty());
}

TEST(PrintStrain, IsNotMadeOfBendsOrLenses) {
  sim::Options bent = WithSeed(31), lens = WithSeed(35);
  bent.disturb.board_bend_m = 5e-4;
  lens.disturb.lens_misfit_px = 0.1;
  for (const sim::Options& options : {bent, lens})
    for (const PrintStretch& stretch : EstimateFrom(Visit(options)).stretches)
      EXPECT_LT(stretch.longer_ratio, 2e-4) << stretch.board.str();
}

}  // namespace
}  // namespace rigcal::calib::joint
