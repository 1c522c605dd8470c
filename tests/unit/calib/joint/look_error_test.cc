// Cameras that are off as a whole from capture to capture: the virtual robot's mounts rattle.
#include <gmock/gmock.h>

#include "server/calib/joint/problem/observation.h"
#include "tests/unit/calib/joint/visit.h"

namespace rigcal::calib::joint {
namespace {

TEST(LookError, MountsThatRattleAreInTheSigmasAndNobodyIsAccused) {
  for (const double sigma_m : {3e-4}) {
    sim::Options options = WithSeed(2);
    options.disturb.rattle = {sigma_m, sigma_m};
    const FeatureSession session = Visit(options);
    const SessionEstimate estimate = EstimateFrom(session);
    ASSERT_THAT(estimate.why_not, testing::IsEmpty());
    EXPECT_LT(WorstT2(session, estimate), 30.0) << sigma_m;
    EXPECT_THAT(estimate.moved, testing::IsEmpty());
    EXPECT_THAT(estimate.late, testing::IsEmpty());
    EXPECT_FALSE(estimate.look_scatter.empty());
    // Boards are some two metres away: a shift by sigma_m is half of that angle.
    for (const LookScatter& one : estimate.look_scatter) EXPECT_NEAR(one.sigma_rad / sigma_m, 0.75, 0.35);
  }
}

TEST(LookError, IsNoneInASessionWhereNothingRattles) {
  EXPECT_THAT(EstimateFrom(Visit(WithSeed(2))).look_scatter, testing::IsEmpty());
}

TEST(LookError, ABumpBesideItIsFound) {
  sim::Options options = WithSeed(3);
  options.disturb.rattle = {2e-4, 2e-4};
  options.bump = SensorId("left_front");
  options.bump_m = 0.02, options.bump_rad = 0.03;
  const SessionEstimate estimate = EstimateFrom(Visit(options));
  ASSERT_EQ(estimate.moved.size(), 1u);
  EXPECT_EQ(estimate.moved[0].sensor, SensorId("left_front"));
}

}  // namespace
}  // namespace rigcal::calib::joint
