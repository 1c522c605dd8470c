#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "server/math/covariance.h"
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
  EXPECT_LT((ShrinkTowardsModel(one, two, 8).C - 1.5 * one).norm(), 1e-15);  // (7 * 1 + 7 * 2) / 14
  EXPECT_LT((ShrinkTowardsModel(one, two, 1).C - two).norm(), 1e-15);
  EXPECT_DOUBLE_EQ(ShrinkTowardsModel(one, two, 8).jackknife_ratio, 0.5);
  EXPECT_DOUBLE_EQ(JackknifeShareMax(40), 39.0 / 46.0);
}

TEST(ShrinkTowardsModel, TrustsAModelThatTheBlocksConfirm) {
  const Matrix6d model = Matrix6d::Identity();
  const auto share = [&](double ratio) { return ShrinkTowardsModel(ratio * model, model, 40).jackknife_ratio; };
  EXPECT_LT(share(1.0), 0.6);  // not below 1/2
  EXPECT_GT(share(1.0), 0.5);
  for (const double off : {0.1, 10.0}) {
    EXPECT_GT(share(off), JackknifeShareMax(40) - 0.02);
    EXPECT_LE(share(off), JackknifeShareMax(40));
  }
  EXPECT_LT(share(1.0), share(1.5));
  EXPECT_LT(share(1.5), share(3.0));
}

// Along five directions of which the sixth is nothing's, in any frame and any unit.
TEST(ShrinkTowardsModel, IsTheSameInEveryFrameAndWhereADirectionIsUnknown) {
  std::mt19937 random(3);
  std::normal_distribution<double> normal;
  Eigen::Matrix<double, 5, 30> samples;
  for (double& value : samples.reshaped()) value = normal(random);
  Matrix6d C_jack = Matrix6d::Zero(), C_model = Matrix6d::Zero();
  C_jack.topLeftCorner<5, 5>() = samples * samples.transpose() / 30;
  C_model.topLeftCorner<5, 5>().setIdentity();
  const double share = ShrinkTowardsModel(C_jack, C_model, 31).jackknife_ratio;
  Vector6d units;
  units << 1e-3, 1e-3, 1e-3, 1e-5, 1e-5, 1e-5;
  Vector6d turn;
  turn << 0.5, -1, 2, 0.3, 0.2, -0.4;
  const Matrix6d A = Matrix6d(units.asDiagonal()) * Adjoint(Se3::Exp(turn));
  const auto moved = ShrinkTowardsModel(Symmetrized(A * C_jack * A.transpose()), Symmetrized(A * C_model * A.transpose()), 31);
  EXPECT_NEAR(moved.jackknife_ratio, share, 1e-9);
  const Matrix6d expected = A * (share * C_jack + (1 - share) * C_model) * A.transpose();
  EXPECT_LT((moved.C - expected).norm(), 1e-9 * expected.norm());
  C_jack(5, 5) = C_model(5, 5) = 1.0;
  EXPECT_NE(ShrinkTowardsModel(C_jack, C_model, 31).jackknife_ratio, share);
}

Matrix6d WishartOf(const Matrix6d& L, int dof, std::mt19937& random) {
  std::normal_distribution<double> normal;
  Matrix6d W = Matrix6d::Zero();
  for (int i = 0; i < dof; ++i) {
    Vector6d z;
    for (double& value : z) value = normal(random);
    const Vector6d x = L * z;
    W += x * x.transpose();
  }
  return W;
}

// Where true covariances scatter around the model as assumed, errors are as large as told on average, also in the
// directions that the estimate itself picks; a weight of 7 for every edge tells them too small.
TEST(ShrinkTowardsModel, IsThePosteriorMean) {
  constexpr int kDraws = 4000, kBlocks = 40;
  std::mt19937 random(11);
  std::uniform_real_distribution<double> even;
  const Matrix6d model = Matrix6d::Identity();
  double ratio = 0, ratio_of_seven = 0;
  for (int i = 0; i < kDraws; ++i) {
    const int kappa = static_cast<int>(std::lround(7.0 * std::pow(39.0 / 7.0, even(random))));
    const Matrix6d precision = WishartOf(model, kappa + 7, random) / kappa;
    const Matrix6d Sigma = Symmetrized(precision.inverse());
    const Matrix6d C_jack = WishartOf(SquareRoot(Sigma), kBlocks - 1, random) / (kBlocks - 1);
    const Matrix6d C = ShrinkTowardsModel(C_jack, model, kBlocks).C;
    const double seven = JackknifeShareMax(kBlocks);
    ratio += (C.inverse() * Sigma).trace() / (6.0 * kDraws);
    ratio_of_seven += ((seven * C_jack + (1 - seven) * model).inverse() * Sigma).trace() / (6.0 * kDraws);
  }
  EXPECT_NEAR(ratio, 1.0, 0.01);
  EXPECT_GT(ratio_of_seven, 1.02);
}

}  // namespace
}  // namespace rigcal
