// Lidars that measure too long at a slant: bias of the virtual lidar, which shares no code with the refinement.
#include <gmock/gmock.h>

#include <cmath>

#include "tests/unit/calib/joint/visit.h"

namespace rigcal::calib::joint {
namespace {

constexpr double kTooLong_m = 0.01;

sim::Options WithBias(std::uint64_t seed, double too_long_m) {
  sim::Options options = WithSeed(seed);
  options.disturb.incidence_bias_m = too_long_m;
  return options;
}

TEST(JointSlant, OfALidarIsTakenOutAndTold) {
  const FeatureSession session = Visit(WithBias(21, kTooLong_m));
  const SessionEstimate estimate = EstimateFrom(session);
  EXPECT_LT(WorstT2(session, estimate), 40.0);  // 6 are expected
  ASSERT_FALSE(estimate.slants.empty());
  for (const SlantBias& slant : estimate.slants) {
    EXPECT_NEAR(slant.too_long_m, kTooLong_m, 4 * slant.sigma_m) << slant.lidar.str();
    EXPECT_LT(slant.sigma_m, 0.005);
  }
}

TEST(JointSlant, IsNotToldWhereThereIsNone) {
  for (const std::uint64_t seed : {22, 23}) {
    const SessionEstimate estimate = EstimateFrom(Visit(WithBias(seed, 0.0)));
    EXPECT_THAT(estimate.slants, testing::IsEmpty()) << "seed " << seed;
  }
}

}  // namespace
}  // namespace rigcal::calib::joint
