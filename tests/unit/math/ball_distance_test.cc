// Against a search over a dense grid of the balls' surfaces and insides, and where the answer is known in closed form.
#include "server/math/ball_distance.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>
#include <random>

namespace rigcal {
namespace {

using Eigen::Vector3d;

Vector6d StepOf(double x, double y, double z, double rx, double ry, double rz) {
  Vector6d step;
  step << x, y, z, rx, ry, rz;
  return step;
}

Vector6d InBall(std::mt19937& random, double radius_m, double radius_rad) {
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> uniform(0, 1);
  Vector6d y;
  for (double& value : y) value = normal(random);
  y.head<3>() *= radius_m * std::cbrt(uniform(random)) / y.head<3>().norm();
  y.tail<3>() *= radius_rad * std::cbrt(uniform(random)) / y.tail<3>().norm();
  return y;
}

TEST(SquaredDistanceFromBalls, WithinBothIsNone) {
  EXPECT_EQ(SquaredDistanceFromBalls(StepOf(5e-4, 5e-4, 0, 0, 0, 9e-4), Matrix6d::Identity() * 1e10, 1e-3, 1e-3), 0.0);
}

// Equal sigmas: each part is as far from its ball as its length is longer than the radius.
TEST(SquaredDistanceFromBalls, OfRoundUncertaintyIsWhatIsBeyondTheRadii) {
  const Matrix6d C = StepOf(1, 1, 1, 4, 4, 4).asDiagonal() * 1e-8;
  const double beyond_m = (3e-3 - 1e-3) / 1e-4, beyond_rad = (5e-3 - 2e-3) / 2e-4;
  EXPECT_NEAR(SquaredDistanceFromBalls(StepOf(0, 3e-3, 0, 0, 0, 5e-3), C.inverse(), 1e-3, 2e-3),
              beyond_m * beyond_m + beyond_rad * beyond_rad, 1e-6);
}

// Known well along x and hardly along z: a step along x is surely beyond, though the length of the whole step is not.
TEST(SquaredDistanceFromBalls, CountsTheDirectionInWhichTheStepIsKnown) {
  const Matrix6d C = StepOf(1e-10, 1e-10, 1e-6, 1e-10, 1e-10, 1e-10).asDiagonal();
  EXPECT_NEAR(std::sqrt(SquaredDistanceFromBalls(StepOf(2e-3, 0, 0, 0, 0, 0), C.inverse(), 1e-3, 1e-3)), 100, 1e-3);
  EXPECT_LT(std::sqrt(SquaredDistanceFromBalls(StepOf(0, 0, 2e-3, 0, 0, 0), C.inverse(), 1e-3, 1e-3)), 1.001);
}

TEST(SquaredDistanceFromBalls, CountsNothingAlongWhatIsNotKnown) {
  Matrix6d W = Matrix6d::Identity() * 1e8;
  W(2, 2) = 0.0;
  EXPECT_NEAR(SquaredDistanceFromBalls(StepOf(2e-3, 0, 5e-1, 0, 0, 0), W, 1e-3, 1e-3), 100, 1e-6);
  EXPECT_EQ(SquaredDistanceFromBalls(StepOf(1, 1, 1, 1, 1, 1), Matrix6d::Zero(), 1e-3, 1e-3), 0.0);
}

// A turn about an axis 3 m away is not known: whatever it brings, a step that is small besides is none.
TEST(SquaredDistanceFromBalls, CountsNothingAlongAnUnknownTurnAboutADistantAxis) {
  Vector6d turn = StepOf(0, 3, 0, 0, 0, 1);
  turn.normalize();
  const Matrix6d onto = Matrix6d::Identity() - turn * turn.transpose();
  const Matrix6d W = 1e10 * onto;
  const Vector6d small = StepOf(5e-4, 0, 0, 0, 8e-4, 0);
  EXPECT_LT(SquaredDistanceFromBalls(small, W, 1e-3, 1e-3), 1e-9);
  EXPECT_NEAR(SquaredDistanceFromBalls(small + 1e-4 * turn, W, 1e-3, 1e-3), 0.0, 1e-6);
  EXPECT_GT(SquaredDistanceFromBalls(StepOf(5e-3, 0, 0, 0, 0, 0) + 1e-3 * turn, W, 1e-3, 1e-3), 1e4);
}

// No step within the balls is nearer than the one found: random covariances with metres and radians tied together.
TEST(SquaredDistanceFromBalls, IsTheLeastOfAll) {
  std::mt19937 random(7);
  std::normal_distribution<double> normal;
  for (int draw = 0; draw < 20; ++draw) {
    Matrix6d F;
    for (double& value : F.reshaped()) value = 3e-4 * normal(random);
    const Matrix6d C = F * F.transpose() + 1e-9 * Matrix6d::Identity();
    Vector6d step;
    for (double& value : step) value = 2e-3 * normal(random);
    const double found = SquaredDistanceFromBalls(step, C.inverse(), 1e-3, 1e-3);
    double least = 1e300;
    for (int i = 0; i < 20'000; ++i) {
      const Vector6d apart = step - InBall(random, 1e-3, 1e-3);
      least = std::min(least, apart.dot(C.ldlt().solve(apart)));
    }
    EXPECT_LE(found, least * (1 + 1e-9)) << draw;
    EXPECT_GT(found, 0.0) << draw;
    EXPECT_GT(found, 0.2 * least) << draw;  // and it is about as far as what a blind search finds
  }
}

}  // namespace
}  // namespace rigcal
