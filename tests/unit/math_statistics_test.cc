#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "server/math/jackknife.h"
#include "server/math/statistics.h"

namespace rigcal {
namespace {

// Printed tables (NIST/SEMATECH e-Handbook of Statistical Methods, 1.3.6.7).
TEST(Quantiles, AgreeWithPrintedTables) {
  EXPECT_NEAR(ChiSquareQuantile(0.95, 6), 12.592, 5e-4);
  EXPECT_NEAR(ChiSquareQuantile(0.99, 1), 6.635, 5e-4);
  EXPECT_NEAR(StudentQuantile(0.975, 10), 2.228, 5e-4);
  EXPECT_NEAR(StudentQuantile(0.025, 10), -2.228, 5e-4);
  EXPECT_NEAR(ChiSquareTail(12.592, 6), 0.05, 1e-5);
}

// With two degrees of freedom the tail is exp(-x/2).
TEST(ChiSquare, ClosedForm) {
  EXPECT_NEAR(ChiSquareTail(3.0, 2), std::exp(-1.5), 1e-15);
  EXPECT_NEAR(ChiSquareQuantile(0.9, 2), -2 * std::log(0.1), 1e-12);
}

TEST(Quantiles, EdgesHaveNoNaN) {
  EXPECT_EQ(ChiSquareTail(0.0, 6), 1.0);
  EXPECT_EQ(ChiSquareTail(-1.0, 6), 1.0);
  EXPECT_EQ(ChiSquareTail(1.0, 0), 0.0);
  EXPECT_EQ(ChiSquareTail(INFINITY, 6), 0.0);
  EXPECT_EQ(ChiSquareQuantile(0.95, 0), 0.0);
  EXPECT_TRUE(std::isinf(ChiSquareQuantile(1.0, 6)));
  EXPECT_TRUE(std::isinf(StudentQuantile(0.975, 0)));
  EXPECT_EQ(StudentQuantile(0.5, 0), 0.0);
}

TEST(HotellingLimit, KnownValues) {
  EXPECT_NEAR(HotellingLimit(40), 16.4, 0.05);
  EXPECT_NEAR(HotellingLimit(11, 1), 2.228139 * 2.228139, 1e-5);  // in one dimension it is Student's t, squared
  EXPECT_NEAR(HotellingLimit(1'000'000), ChiSquareQuantile(0.95, 6), 1e-3);
}

TEST(HotellingLimit, TooFewBlocksAllowAnything) {
  EXPECT_TRUE(std::isinf(HotellingLimit(6)));
  EXPECT_TRUE(std::isinf(HotellingLimit(0)));
  EXPECT_TRUE(std::isfinite(HotellingLimit(7)));
}

// For a mean the jackknife is exactly the textbook's variance of a mean, s^2 / m.
TEST(Jackknife, OfAMeanIsTheVarianceOfTheMean) {
  constexpr int kM = 12;
  std::mt19937 random(5);
  std::normal_distribution<double> normal;
  Eigen::Matrix<double, 6, kM> samples;
  for (double& value : samples.reshaped()) value = normal(random);
  const Vector6d mean = samples.rowwise().mean();
  std::vector<Vector6d> d;
  for (int i = 0; i < kM; ++i) d.emplace_back((samples.rowwise().sum() - samples.col(i)) / (kM - 1) - mean);
  const auto centred = samples.colwise() - mean;
  const Matrix6d expected = centred * centred.transpose() / (kM - 1) / kM;
  EXPECT_LT((JackknifeCovariance(d) - expected).norm(), 1e-15);
}

// Two blocks 2 apart on z: deviations -1 and 1, (2-1)/2 * 2 = 1.
TEST(Jackknife, SpreadOnOneAxisStaysThere) {
  const std::vector<Vector6d> d = {3.0 * Vector6d::Unit(tangent::kZ), 5.0 * Vector6d::Unit(tangent::kZ)};
  Matrix6d expected = Matrix6d::Zero();
  expected(tangent::kZ, tangent::kZ) = 1.0;
  EXPECT_LT((JackknifeCovariance(d) - expected).norm(), 1e-15);
}

TEST(JackknifeDeathTest, OneBlockIsABrokenInvariant) {
  EXPECT_DEATH((void)JackknifeCovariance({Vector6d::Zero()}), "two blocks");
}

TEST(ShrinkTowardsModel, WeighsByBlocks) {
  const Matrix6d one = Matrix6d::Identity(), two = 2.0 * one;
  EXPECT_LT((ShrinkTowardsModel(one, two, 8) - 1.5 * one).norm(), 1e-15);  // (7 * 1 + 7 * 2) / 14
  EXPECT_LT((ShrinkTowardsModel(one, two, 1) - two).norm(), 1e-15);
}

}  // namespace
}  // namespace rigcal
