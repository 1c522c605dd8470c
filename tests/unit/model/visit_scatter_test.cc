#include "server/model/graph/visit_scatter.h"

#include <gtest/gtest.h>

namespace rigcal {
namespace {

constexpr ScatterOfAxes kPool{4.0, 1.0, 20.0};

TEST(TakenScatter, WithoutAPoolIsTheRobotsOwnAndNeverBelowZero) {
  const ScatterTaken own = TakenScatter({2.0, 1.0, 6.0}, std::nullopt);
  EXPECT_EQ(own.variance, 2.0);
  EXPECT_EQ(own.dof, 6.0);
  EXPECT_FALSE(own.by_pool);
  EXPECT_EQ(TakenScatter({-0.5, 1.0, 6.0}, std::nullopt).variance, 0.0);
}

TEST(TakenScatter, IsTheMeanByDegreesOfFreedom) {
  const ScatterTaken taken = TakenScatter({2.0, 1.0, 10.0}, kPool);
  EXPECT_NEAR(taken.variance, (10 * 2.0 + 20 * 4.0) / 30, 1e-12);
  EXPECT_NEAR(taken.dof, 30.0, 1e-12);
  EXPECT_TRUE(taken.by_pool);
}

// Held at zero it would be too large on average.
TEST(TakenScatter, CountsVisitsThatAgreeBetterThanTheySay) {
  EXPECT_NEAR(TakenScatter({-0.7, 1.0, 10.0}, kPool).variance, (10 * -0.7 + 20 * 4.0) / 30, 1e-12);
}

TEST(TakenScatter, OfOneVisitIsThePoolsAlone) {
  const ScatterTaken taken = TakenScatter({0.0, 1.0, 0.0}, kPool);
  EXPECT_EQ(taken.variance, 4.0);
  EXPECT_NEAR(taken.dof, 20.0, 1e-12);
}

// What the pool knows is 4 + 1 to a part; of a robot whose visits err by nothing 4 is known less well, of one whose visits err
// by more not better.
TEST(TakenScatter, APoolOfRougherVisitsIsLessSure) {
  EXPECT_NEAR(TakenScatter({0.0, 0.0, 0.0}, kPool).dof, 20.0 * (4.0 / 5) * (4.0 / 5), 1e-12);
  EXPECT_NEAR(TakenScatter({0.0, 3.0, 0.0}, kPool).dof, 20.0, 1e-12);
}

TEST(TakenScatter, ARobotThatShowsFarMoreThanItsPoolIsTakenByItself) {
  const ScatterTaken taken = TakenScatter({40.0, 1.0, 9.0}, kPool);
  EXPECT_EQ(taken.variance, 40.0);
  EXPECT_EQ(taken.dof, 9.0);
  EXPECT_FALSE(taken.by_pool);
}

}  // namespace
}  // namespace rigcal
