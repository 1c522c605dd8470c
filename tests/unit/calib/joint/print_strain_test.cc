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

void KeepFirstViews(const TargetId& board, std::ptrdiff_t count, FeatureSession& session) {
  for (const sim::RigSensor& sensor : session.experiment.rig.sensors) {
    if (sensor.kind != SensorKind::kCamera || sensor.sees != board) continue;
    auto& views = session.seen.views.at(sensor.id);
    views.erase(std::next(views.begin(), count), views.end());
  }
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

// A bump makes a camera look noisy, and hides what prints do until it is taken out.
TEST(PrintStrain, IsFoundBesideABump) {
  sim::Options options = WithStretch(31, 0.003);
  options.bump = SensorId("left_front");
  options.bump_m = 0.02, options.bump_rad = 0.035;
  const FeatureSession session = Visit(options);
  const SessionEstimate estimate = EstimateFrom(session);
  ASSERT_EQ(estimate.moved.size(), 1u);
  EXPECT_EQ(estimate.moved[0].sensor.str(), "left_front");
  EXPECT_FALSE(estimate.stretches.empty());
}

// Prints all stretched alike, one of which is seen too seldom to tell: it takes part all the same.
TEST(PrintStrain, OfABoardThatTellsLittleIsNotTakenForNone) {
  FeatureSession session = Visit(WithStretch(31, 0.001));
  const SessionEstimate whole = EstimateFrom(session);
  ASSERT_FALSE(whole.stretches.empty());
  const TargetId seldom = whole.stretches.front().board;
  KeepFirstViews(seldom, 3, session);
  const SessionEstimate estimate = EstimateFrom(session);
  EXPECT_LT(WorstT2(session, estimate), 30.0) << seldom.str();
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
