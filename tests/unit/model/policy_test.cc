#include "server/model/approval/policy.h"

#include <gtest/gtest.h>

#include <array>

namespace rigcal {
namespace {

const SensorId kLeft("left"), kRight("right"), kTop("top");

TEST(Policy, WithoutAWordTheDefaultsHold) {
  const PoseLimits limits = LimitsOf(Policy(), kLeft);
  EXPECT_EQ(limits.tolerance, (PoseLimit{0.005, 0.005}));
  EXPECT_EQ(limits.moved_min.m, 0.001);
  EXPECT_DOUBLE_EQ(limits.moved_min.rad, 0.05 * M_PI / 180);
  EXPECT_EQ(LimitsOf(Policy(), kLeft, kRight), limits);
  EXPECT_EQ(ResidualMaxOf(Policy()), (PoseLimit{0.05, 0.05}));
}

TEST(Policy, WhatIsSaidOfASensorGoesBeforeWhatIsSaidOfAll) {
  Policy policy;
  policy.all.tolerance_m = 0.003;
  policy.sensors[kTop].tolerance_m = 0.02;
  EXPECT_EQ(LimitsOf(policy, kLeft).tolerance, (PoseLimit{0.003, 0.005}));
  EXPECT_EQ(LimitsOf(policy, kTop).tolerance, (PoseLimit{0.02, 0.005}));
}

TEST(Policy, OfAPairTheWiderHoldsUntilThePairIsNamed) {
  Policy policy;
  policy.sensors[kTop].tolerance_m = 0.02;
  policy.sensors[kLeft].moved_min_m = 0.0005;
  EXPECT_EQ(LimitsOf(policy, kTop, kLeft).tolerance.m, 0.02);
  EXPECT_EQ(LimitsOf(policy, kTop, kLeft).moved_min.m, 0.001);
  policy.pairs[{kLeft, kTop}].tolerance_m = 0.004;
  for (const auto& [a, b] : {std::pair{kLeft, kTop}, std::pair{kTop, kLeft}})
    EXPECT_EQ(LimitsOf(policy, a, b).tolerance.m, 0.004);
  const std::array<SensorId, 3> loop = {kLeft, kTop, kRight};
  EXPECT_EQ(LimitsOfLoop(policy, loop).tolerance.m, 0.02);  // top - right
}

TEST(Policy, PixelsAreAnAngleOfCamerasWhoseFocalLengthIsKnown) {
  Policy policy;
  policy.all.tolerance_px_at_10_m = 2.0;
  EXPECT_EQ(LimitsOf(policy, kLeft).tolerance.rad, 0.005);
  policy.focal_px[kLeft] = 1000.0;
  EXPECT_NEAR(LimitsOf(policy, kLeft).tolerance.rad, 0.002, 1e-8);
  policy.sensors[kLeft].tolerance_rad = 0.001;  // the smaller holds
  EXPECT_EQ(LimitsOf(policy, kLeft).tolerance.rad, 0.001);
}

TEST(Policy, ANarrowerOneOverridesKeyByKey) {
  Policy fleet, model, robot;
  fleet.all.tolerance_m = 0.004, fleet.all.moved_min_m = 0.002, fleet.max_age_ns = 90;
  fleet.sensors[kTop].tolerance_m = 0.02;
  model.all.tolerance_m = 0.006, model.captures_min = 20, model.visits_in_full = 12;
  robot.max_age_ns = 30, robot.sensors[kTop].tolerance_rad = 0.01;
  const Policy sum = Overlaid(Overlaid(fleet, model), robot);
  EXPECT_EQ(LimitsOf(sum, kLeft).tolerance.m, 0.006);
  EXPECT_EQ(LimitsOf(sum, kLeft).moved_min.m, 0.002);
  EXPECT_EQ(LimitsOf(sum, kTop).tolerance, (PoseLimit{0.02, 0.01})) << "a sensor's own word stays";
  EXPECT_EQ(sum.max_age_ns, 30);
  EXPECT_EQ(sum.captures_min, 20);
  EXPECT_EQ(sum.visits_in_full, 12);
  EXPECT_EQ(Overlaid(fleet, Policy()), fleet);
}

TEST(Policy, WhatIsAsLargeAsTheLimitKeepsIt) {
  const PoseLimit limit{0.25, 0.5};
  Vector6d off = Vector6d::Zero();
  off[0] = 0.25, off[4] = 0.5;
  EXPECT_FALSE(IsBeyond(off, limit));
  off[4] = 0.50001;
  EXPECT_TRUE(IsBeyond(off, limit));
  off << 0.3, 0, 0, 0, 0, 0;
  EXPECT_TRUE(IsBeyond(off, limit));
  EXPECT_DOUBLE_EQ(TimesLimit(off, limit), 1.2);
}

}  // namespace
}  // namespace rigcal
