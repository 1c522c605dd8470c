#include "server/math/statistics.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <random>

#include "server/math/covariance.h"
#include "server/math/jackknife.h"

namespace rigcal {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

// Printed tables (NIST/SEMATECH e-Handbook of Statistical Methods, 1.3.6.7).
TEST(Quantiles, AgreeWithPrintedTables) {
  EXPECT_NEAR(ChiSquareQuantile(0.95, 6), 12.592, 5e-4);
  EXPECT_NEAR(ChiSquareQuantile(0.99, 1), 6.635, 5e-4);
  EXPECT_NEAR(StudentQuantile(0.975, 10), 2.228, 5e-4);
  EXPECT_NEAR(StudentQuantile(0.025, 10), -2.228, 5e-4);
  EXPECT_NEAR(ChiSquareTail(12.592, 6), 0.05, 1e-5);
}

// Against draws: a chi-square over a chi-square with a shifted mean.
TEST(Statistics, PowerOfAnFTest) {
  const double limit = FisherQuantile(1e-3, 6, 40);
  EXPECT_NEAR(FisherTail(limit, 6, 40), 1e-3, 1e-12);
  const double noncentrality = FisherNoncentrality(limit, 6, 40, 0.95);
  std::mt19937_64 random(1);
  std::normal_distribution<double> normal;
  const auto squares = [&](int count, double shift) {
    double sum = 0;
    for (int i = 0; i < count; ++i) sum += std::pow(normal(random) + (i == 0 ? shift : 0.0), 2);
    return sum / count;
  };
  int told = 0;
  for (int draw = 0; draw < 4000; ++draw) told += squares(6, std::sqrt(noncentrality)) / squares(40, 0) > limit ? 1 : 0;
  EXPECT_NEAR(told / 4000.0, 0.95, 0.015);
  EXPECT_TRUE(std::isinf(FisherQuantile(1e-3, 6, 0)));
  EXPECT_TRUE(std::isinf(FisherNoncentrality(FisherQuantile(1e-3, 6, 0), 6, 0, 0.95)));
  // Degrees of freedom that are parts of one: hardly anything is told, and nothing is thrown.
  for (const double nu : {1e-3, 0.05, 0.1, 0.3, 0.5, 0.8, 1.0, 1.3, 1.6, 2.0})
    for (const double looks : {100.0, 800.0})
      EXPECT_GT(FisherNoncentrality(FisherQuantile(5e-4 / looks, 6, nu), 6, nu, 0.95), 1e3) << nu;
  EXPECT_EQ(FisherNoncentrality(0.1, 6, 40, 0.5), 0.0);  // beyond it without any help
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

// Blocks whose jackknife is exactly `C`, in pairs of opposite signs along its axes.
std::vector<Vector6d> BlocksOf(const Matrix6d& C) {
  const Matrix6d F = SquareRoot(C);
  const double m = 12;
  std::vector<Vector6d> d;
  for (int i = 0; i < 6; ++i)
    for (const double sign : {-1.0, 1.0}) d.push_back(sign * std::sqrt(m / (m - 1) / 2) * F.col(i));
  return d;
}

TEST(JackknifeOrModel, IsTheModelWhereTheBlocksConfirmItOrShowLess) {
  const Matrix6d one = Matrix6d::Identity();
  ASSERT_LT((JackknifeCovariance(BlocksOf(one)) - one).norm(), 1e-14);
  EXPECT_LT((JackknifeOrModel(BlocksOf(one), one) - one).norm(), 1e-14);
  EXPECT_LT((JackknifeOrModel(BlocksOf(0.1 * one), one) - one).norm(), 1e-14);
}

TEST(JackknifeOrModel, IsTheBlocksWhereTheyShowMore) {
  const Matrix6d one = Matrix6d::Identity();
  EXPECT_LT((JackknifeOrModel(BlocksOf(9.0 * one), one) - 9.0 * one).norm(), 1e-12);
}

MatrixXd Draws(int p, int count, std::mt19937& random) {
  std::normal_distribution<double> normal;
  MatrixXd draws(p, count);
  for (double& value : draws.reshaped()) value = normal(random);
  return draws;
}

std::vector<Vector6d> ColumnsOf(const MatrixXd& columns) {
  std::vector<Vector6d> d;
  for (Eigen::Index i = 0; i < columns.cols(); ++i) d.emplace_back(columns.col(i));
  return d;
}

// Along five directions of which the sixth is nothing's, in any frame and any unit.
TEST(JackknifeOrModel, IsTheSameInEveryFrameAndWhereADirectionIsUnknown) {
  std::mt19937 random(3);
  MatrixXd d = MatrixXd::Zero(6, 30);
  d.topRows(5) = 2.0 * Draws(5, 30, random) / 30;
  Matrix6d C_model = Matrix6d::Zero();
  C_model.topLeftCorner<5, 5>() = Eigen::Matrix<double, 5, 5>::Identity() / 30;
  const Matrix6d here = JackknifeOrModel(ColumnsOf(d), C_model);
  Vector6d units;
  units << 1e-3, 1e-3, 1e-3, 1e-5, 1e-5, 1e-5;
  Vector6d turn;
  turn << 0.5, -1, 2, 0.3, 0.2, -0.4;
  const Matrix6d A = Matrix6d(units.asDiagonal()) * Adjoint(Se3::Exp(turn));
  const Matrix6d moved = JackknifeOrModel(ColumnsOf(A * d), Symmetrized(A * C_model * A.transpose()));
  const Matrix6d expected = A * here * A.transpose();
  EXPECT_LT((moved - expected).norm(), 1e-8 * expected.norm());
  EXPECT_EQ(Observable(here).rank, 5);
}

// Mean of err^2 over the variance told, for errors of which 40 blocks show one draw; the model tells `size` of it.
double MeanSquare(double size) {
  constexpr int kDraws = 2000, kBlocks = 40;
  std::mt19937 random(11);
  double sum = 0;
  for (int draw = 0; draw < kDraws; ++draw) {
    const Matrix6d C =
        JackknifeOrModel(ColumnsOf(Draws(6, kBlocks, random) / (kBlocks - 1)), size / kBlocks * Matrix6d::Identity());
    sum += C.inverse().trace() / kBlocks / 6 / kDraws;
  }
  return sum;
}

TEST(JackknifeOrModel, TellsErrorsAsLargeAsTheyAreWhereTheModelIsTooSure) {
  EXPECT_NEAR(MeanSquare(1.0), 0.93, 0.07);  // never below the model, so a little too wide
  EXPECT_NEAR(MeanSquare(0.25), 1.0, 0.07);
}

}  // namespace
}  // namespace rigcal
