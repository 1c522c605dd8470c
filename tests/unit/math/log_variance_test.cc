#include "server/math/log_variance.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

namespace rigcal {
namespace {

constexpr double kEuler = 0.5772156649015329;

// digamma(1) = -gamma, trigamma(1) = pi^2 / 6; digamma(1/2) = -gamma - 2 log 2, trigamma(1/2) = pi^2 / 2.
TEST(LogVariance, HasItsClosedForms) {
  EXPECT_NEAR(LogVarianceBias(2), -kEuler, 1e-12);
  EXPECT_NEAR(LogVarianceSpread(2), M_PI * M_PI / 6, 1e-12);
  EXPECT_NEAR(LogVarianceBias(1), -kEuler - 2 * std::log(2.0) - std::log(0.5), 1e-12);
  EXPECT_NEAR(LogVarianceSpread(1), M_PI * M_PI / 2, 1e-12);
}

TEST(LogVariance, IsThatOfDraws) {
  std::mt19937 engine(1);
  constexpr int kDraws = 200'000;
  for (const double dof : {3.0, 15.0}) {
    std::chi_squared_distribution<> chi_square(dof);
    double sum = 0.0, squares = 0.0;
    for (int i = 0; i < kDraws; ++i) {
      const double z = std::log(chi_square(engine) / dof);
      sum += z, squares += z * z;
    }
    const double mean = sum / kDraws, variance = squares / kDraws - mean * mean;
    EXPECT_NEAR(mean, LogVarianceBias(dof), 6 * std::sqrt(variance / kDraws)) << dof;
    EXPECT_NEAR(variance, LogVarianceSpread(dof), 0.03 * variance) << dof;
  }
}

TEST(LogVariance, SpreadGivesBackItsFreedom) {
  for (const double dof : {0.5, 3.0, 6.0, 27.0, 200.0, 1e6})
    EXPECT_NEAR(DofOfLogVarianceSpread(LogVarianceSpread(dof)) / dof, 1.0, 1e-6) << dof;
  EXPECT_TRUE(std::isinf(DofOfLogVarianceSpread(0.0)));
  EXPECT_TRUE(std::isinf(DofOfLogVarianceSpread(-0.1)));
  EXPECT_EQ(DofOfLogVarianceSpread(std::numeric_limits<double>::infinity()), 0.0);
  EXPECT_TRUE(std::isinf(LogVarianceSpread(0)));
}

}  // namespace
}  // namespace rigcal
