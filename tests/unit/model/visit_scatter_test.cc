#include "server/model/graph/visit_scatter.h"

#include <gtest/gtest.h>

#include <cmath>

namespace rigcal {
namespace {

constexpr ScatterOfAxes kPool{4.0, 1.0, 20.0};

TEST(TakenScatter, WithoutAPoolIsTheRobotsOwnAndNeverBelowZero) {
  const ScatterTaken own = TakenScatter({2.0, 1.0, 6.0}, std::nullopt);
  EXPECT_EQ(own.variance, 2.0);
  EXPECT_EQ(own.dof, 3.0);
  EXPECT_FALSE(own.by_pool);
  EXPECT_EQ(TakenScatter({-0.5, 1.0, 6.0}, std::nullopt).variance, 0.0);
}

// By hand: 5 numbers of an axis, 1.5 of the two sensors on the whole, whose scatter is 2 and 6 to visits that err by 1.
TEST(TakenScatter, WithoutAPoolEachAxisGoesByItselfAndALittleByTheRobot) {
  const ScatterOfAxes own{2.0, 1.0, 15.0, {2.5, 0.4, 0.1}}, other{6.0, 3.0, 15.0, {1.0, 1.0, 1.0}},
      of_one_visit{0.0, 1.0, 0.0};
  const ScatterTaken taken = TakenScatter(own, std::nullopt, {own, other, of_one_visit});
  const double on_the_whole = std::sqrt(3.0 * 7.0) - 1;
  const ThreeAxes shown = {7.5 - 1, 1.2 - 1, 0.3 - 1};
  EXPECT_NEAR(taken.dof, 6.5, 1e-12);
  for (std::size_t axis = 0; axis < 3; ++axis)
    EXPECT_NEAR(taken.variance * taken.share[axis], std::max(0.0, (5 * shown[axis] + 1.5 * on_the_whole) / 6.5), 1e-12)
        << axis;
  EXPECT_NEAR(taken.share[0] + taken.share[1] + taken.share[2], 3.0, 1e-12);
  EXPECT_FALSE(taken.by_pool);
}

TEST(TakenScatter, WithoutAPoolVisitsThatAgreeScatterByNothing) {
  const ScatterTaken taken = TakenScatter({-0.5, 1.0, 15.0, {1.0, 1.0, 1.0}}, std::nullopt);
  EXPECT_EQ(taken.variance, 0.0);
  EXPECT_EQ(taken.dof, 6.0);
  EXPECT_TRUE(taken.AxesAreAlike());
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

// What the pool knows is 4 + 1 to a part; of a robot whose visits err by nothing 4 is known less well, of one whose
// visits err by more not better.
TEST(TakenScatter, APoolOfRougherVisitsIsLessSure) {
  EXPECT_NEAR(TakenScatter({0.0, 0.0, 0.0}, kPool).dof, 20.0 * (4.0 / 5) * (4.0 / 5), 1e-12);
  EXPECT_NEAR(TakenScatter({0.0, 3.0, 0.0}, kPool).dof, 20.0, 1e-12);
}

// By hand: along x 4 of a mean of 2, along the others 1; visits err by 1.
TEST(TakenScatter, AxesAreAsUnlikeAsThePoolTells) {
  ScatterOfAxes pool = kPool, own{2.0, 1.0, 10.0};
  pool.ratio = {2.0, 0.5, 0.5};
  EXPECT_EQ(TakenScatter(own, pool).variance, (10 * 2.0 + 20 * 4.0) / 30);  // it does not tell its axes
  own.ratio = {5.0 / 3, 2.0 / 3, 2.0 / 3};
  const ScatterTaken taken = TakenScatter(own, pool);
  const double dof = 10.0 / 3 * (1 + 2 * std::pow((0.5 / 3) / (2.0 / 9), 2));  // about the pool's 4
  EXPECT_LT(dof, 10);
  EXPECT_NEAR(taken.dof, dof + 20, 1e-9);
  EXPECT_NEAR(taken.variance, (dof * 2.0 + 20 * 4.0) / (dof + 20), 1e-9);
  EXPECT_EQ(taken.share, pool.ratio);
  EXPECT_FALSE(taken.AxesAreAlike());
  const Vector6d along = AlongAxes(taken, {3.0, 5.0});
  EXPECT_NEAR(along[0], 2 * taken.variance, 1e-12);
  EXPECT_NEAR(along[2], 0.5 * taken.variance, 1e-12);
  EXPECT_EQ(along[5], 3.0);
}

TEST(TakenScatter, OfAxesThatAreAlikeItIsAsSureAsOfThree) {
  const ScatterOfAxes own{2.0, 1.0, 9.0, {1.5, 0.5, 1.0}}, mean = InShares({1, 1, 1}, 3.0, own);
  EXPECT_NEAR(mean.between, 2.0, 1e-12);
  EXPECT_NEAR(mean.dof, 9.0, 1e-12);
}

// Whatever the visits err by along the axes that do not scatter.
TEST(TakenScatter, OfOneAxisThatHasAllItIsAsSureAsOfOne) {
  for (const double own_m2 : {0.01, 0.1, 0.5}) {
    const double shown = 2.0 + own_m2;  // 6 along x, and what visits err by
    const ScatterOfAxes own{2.0, own_m2, 9.0, {(6 + own_m2) / shown, own_m2 / shown, own_m2 / shown}};
    const ScatterOfAxes mean = InShares({3, 1e-9, 1e-9}, 2.0, own);
    EXPECT_NEAR(mean.between, 2.0, 1e-6);
    EXPECT_NEAR(mean.dof, 3.0, 1e-6);
  }
}

TEST(TakenScatter, APoolThatTellsOnlyTheAxesLeavesTheScaleToTheRobot) {
  const ScatterOfAxes pool{0.0, 1.0, 0.0, {2.0, 0.5, 0.5}};
  const ScatterTaken taken = TakenScatter({2.0, 1.0, 10.0, {5.0 / 3, 2.0 / 3, 2.0 / 3}}, pool);
  EXPECT_NEAR(taken.variance, 2.0, 1e-12);
  EXPECT_LT(taken.dof, 10.0);
  EXPECT_EQ(taken.share, pool.ratio);
  EXPECT_FALSE(taken.by_pool);
  EXPECT_TRUE(TakenScatter({0.0, 1.0, 0.0}, pool).AxesAreAlike());  // of one visit nothing tells of what it is a share
}

TEST(TakenScatter, ARobotThatShowsFarMoreThanItsPoolIsTakenByItself) {
  const ScatterTaken taken = TakenScatter({40.0, 1.0, 9.0}, kPool);
  EXPECT_EQ(taken.variance, 40.0);
  EXPECT_EQ(taken.dof, 4.0);
  EXPECT_FALSE(taken.by_pool);
}

}  // namespace
}  // namespace rigcal
