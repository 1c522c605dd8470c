#include <gtest/gtest.h>

#include "server/math/statistics.h"
#include "tests/unit/calib/virtual_motion.h"

namespace rigcal::calib {
namespace {

// Of 120 regions of 95 % 114 cover, with a sigma of 2.4; 92 are nine sigma below.
TEST(HandEyeStatistics, RegionsCoverTheTruth) {
  int covered = 0;
  for (unsigned seed = 0; seed < 120; ++seed) {
    const VirtualBody body = Driven(Drive::kFree, 40, 0.3, seed);
    const auto result = EstimateHandEye(Tracked(body, {0.001, 0.001}, {0.0003, 0.002}, 4000 + seed));
    ASSERT_TRUE(result);
    const Vector6d e = (result->estimate.T_a_b.Inverse() * body.X).Log();
    covered += e.dot(result->uncertainty.Omega * e) <= HotellingLimit(result->uncertainty.dof + 1) ? 1 : 0;
  }
  EXPECT_GE(covered, 92);
}

}  // namespace
}  // namespace rigcal::calib
