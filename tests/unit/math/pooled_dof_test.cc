#include "server/math/pooled_dof.h"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <random>
#include <vector>

#include "server/math/se3.h"
#include "server/math/statistics.h"

namespace rigcal {
namespace {

Matrix6d RandomCovariance(std::mt19937& random) {
  std::normal_distribution<double> normal;
  Eigen::Matrix<double, 6, 9> samples;
  for (double& value : samples.reshaped()) value = normal(random);
  Vector6d units;
  units << 1e-3, 1e-3, 1e-3, 1e-5, 1e-5, 1e-5;
  return units.asDiagonal() * Matrix6d(samples * samples.transpose()) * units.asDiagonal();
}

TEST(PooledDof, OfOnePartIsItsOwn) {
  std::mt19937 random(1);
  const Matrix6d part = RandomCovariance(random);
  PooledDof pooled;
  pooled.Add(part, 39);
  EXPECT_NEAR(pooled.Of(part), 39.0, 1e-6);
  EXPECT_NEAR(pooled.Of(2 * part), 4 * 39.0, 1e-6);  // half of it known
}

// In one direction it is Welch's and Satterthwaite's.
TEST(PooledDof, InOneDirectionIsSatterthwaites) {
  const Vector6d along = (Vector6d() << 3, 0, -2, 1, 0, 5).finished();
  const Matrix6d unit = along * along.transpose();
  PooledDof pooled;
  pooled.Add(2 * unit, 10);
  pooled.Add(3 * unit, 25);
  EXPECT_NEAR(pooled.Of(6 * unit), 36.0 / (4.0 / 10 + 9.0 / 25), 1e-6);
}

TEST(PooledDof, IsTheSameInEveryFrame) {
  std::mt19937 random(2);
  const Matrix6d a = RandomCovariance(random), b = RandomCovariance(random), known = RandomCovariance(random);
  const Matrix6d M = Adjoint(Se3::Exp((Vector6d() << 0.5, -2, 1, 0.3, -1, 2).finished()));
  PooledDof here, there;
  here.Add(a, 19), here.Add(b, 7);
  there.Add(M * a * M.transpose(), 19), there.Add(M * b * M.transpose(), 7);
  const Matrix6d sum = a + b + known;
  EXPECT_NEAR(here.Of(sum), there.Of(M * sum * M.transpose()), 1e-6 * here.Of(sum));
}

TEST(PooledDof, WithoutAnEstimateIsZero) {
  std::mt19937 random(3);
  EXPECT_EQ(PooledDof().Of(RandomCovariance(random)), 0.0);
  PooledDof pooled;
  pooled.Add(Matrix6d::Zero(), 5);
  EXPECT_EQ(pooled.Of(Matrix6d::Zero()), 0.0);
}

Vector6d Draw(const Matrix6d& factor, std::mt19937& random) {
  std::normal_distribution<double> normal;
  Vector6d z;
  for (double& value : z) value = normal(random);
  return factor * z;
}

// Two estimated parts and a known one, of very different shares by direction; the region covers what it says.
TEST(PooledDof, MakesHotellingsRegionCover) {
  constexpr int kTrials = 20000;
  std::mt19937 random(4);
  const Vector6d shares_a(0.9, 0.8, 0.1, 0.05, 0.3, 0.4), shares_b(0.05, 0.1, 0.2, 0.9, 0.3, 0.1);
  const Matrix6d known = (Vector6d::Ones() - shares_a - shares_b).asDiagonal();
  const Matrix6d factor_a = shares_a.cwiseSqrt().asDiagonal(), factor_b = shares_b.cwiseSqrt().asDiagonal();
  int covered = 0;
  for (int trial = 0; trial < kTrials; ++trial) {
    PooledDof pooled;
    Matrix6d sum = known;
    for (const auto& [factor, dof] : {std::pair(factor_a, 39), std::pair(factor_b, 15)}) {
      Matrix6d part = Matrix6d::Zero();
      for (int i = 0; i < dof; ++i) {
        const Vector6d one = Draw(factor, random);
        part += one * one.transpose() / dof;
      }
      pooled.Add(part, dof);
      sum += part;
    }
    const Vector6d error = Draw(Matrix6d::Identity(), random);
    covered += error.dot(sum.ldlt().solve(error)) <= HotellingLimit(static_cast<int>(pooled.Of(sum)) + 1);
  }
  EXPECT_NEAR(static_cast<double>(covered) / kTrials, 0.95, 0.01);  // spread 0.0016
}

TEST(PooledDof, OfBlocksThatCarryAlikeIsTheirNumber) {
  Eigen::Matrix<double, 6, Eigen::Dynamic> columns(6, 12);
  columns << Matrix6d::Identity(), -Matrix6d::Identity();
  PooledDof pooled;
  pooled.AddBlocks(columns, 11);
  EXPECT_NEAR(pooled.Of(columns * columns.transpose()), 11.0, 1e-9);
}

// In one direction the sum of squares of m normal numbers scatters by m/(m-1) [sum c^4 - (sum c^2)^2 / m].
TEST(PooledDof, OfBlocksThatCarryUnevenlyIsLess) {
  const Vector6d along = (Vector6d() << 3, 0, -2, 1, 0, 5).finished();
  const Eigen::RowVectorXd c = (Eigen::RowVectorXd(10) << 9, 1, -1, 1, -8, 1, 1, -1, 1, 1).finished();
  PooledDof pooled;
  pooled.AddBlocks(along * c, 9);
  const double squares = c.squaredNorm(), fourths = c.cwiseAbs2().squaredNorm();
  const double scatter = 10.0 / 9.0 * (fourths - squares * squares / 10.0);
  EXPECT_NEAR(pooled.Of(along * along.transpose() * squares), 2 * squares * squares / scatter, 1e-9);
  const Matrix6d M = Adjoint(Se3::Exp((Vector6d() << 0.5, -2, 1, 0.3, -1, 2).finished()));
  PooledDof there;
  there.AddBlocks(M * along * c, 9);
  EXPECT_NEAR(there.Of(M * along * along.transpose() * M.transpose() * squares),
              pooled.Of(along * along.transpose() * squares), 1e-9);
}

// Captures in which this sensor saw nothing are blocks without a say; edges with fewer of them lower the number given.
TEST(PooledDof, BlocksThatSayNothingDoNotCountTwice) {
  Eigen::Matrix<double, 6, Eigen::Dynamic> columns(6, 12), more(6, 40);
  columns << Matrix6d::Identity(), -Matrix6d::Identity();
  more.setZero();
  more.leftCols(12) = columns;
  PooledDof few, many;
  few.AddBlocks(columns, 11);
  many.AddBlocks(more, 11);
  const Matrix6d sum = columns * columns.transpose();
  EXPECT_NEAR(many.Of(sum), few.Of(sum), 1e-9);
  PooledDof fewer;
  fewer.AddBlocks(columns, 7);
  EXPECT_NEAR(fewer.Of(sum), 7.0, 1e-9);
}

// Two directions that are known very differently well, turned against the axes.
TEST(PooledDof, HoldsWhereErrorsGoTogether) {
  std::mt19937 random(6);
  std::normal_distribution<double> normal;
  Eigen::Matrix<double, 6, Eigen::Dynamic> columns(6, 40);
  for (double& value : columns.reshaped()) value = normal(random);
  PooledDof round;
  round.AddBlocks(columns, 39);
  const double expected = round.Of(columns * columns.transpose());
  Matrix6d M = Matrix6d::Identity();
  M(0, 0) = 1e-5;
  M = M * Matrix6d(Adjoint(Se3::Exp((Vector6d() << 0.5, -2, 1, 0.3, -1, 2).finished())));
  M = Matrix6d(Adjoint(Se3::Exp((Vector6d() << 1, 1, -1, 2, 0.7, 0.1).finished()))) * M;
  PooledDof flat(1.7 * M * columns * columns.transpose() * M.transpose());
  flat.AddBlocks(M * columns, 39);
  EXPECT_NEAR(flat.Of(M * columns * columns.transpose() * M.transpose()), expected, 1e-3 * expected);
}

// Of 40 blocks a quarter carries most: what is estimated is as uncertain as of fewer.
TEST(PooledDof, MakesTheRegionOfUnevenBlocksCover) {
  constexpr int kTrials = 20000, kBlocks = 40;
  std::mt19937 random(5);
  int covered = 0, covered_as_if_alike = 0;
  for (int trial = 0; trial < kTrials; ++trial) {
    Eigen::Matrix<double, 6, Eigen::Dynamic> columns(6, kBlocks);
    double variance = 0;
    for (int b = 0; b < kBlocks; ++b) {
      const double sigma = b % 4 == 0 ? 1.0 : 0.2;
      columns.col(b) = Draw(sigma * Matrix6d::Identity(), random);
      variance += sigma * sigma;
    }
    const Matrix6d sum = columns * columns.transpose();
    PooledDof pooled;
    pooled.AddBlocks(columns, kBlocks);
    const Vector6d error = Draw(std::sqrt(variance) * Matrix6d::Identity(), random);
    const double square = error.dot(sum.ldlt().solve(error));
    covered += square <= HotellingLimit(static_cast<int>(pooled.Of(sum)) + 1);
    covered_as_if_alike += square <= HotellingLimit(kBlocks + 1);
  }
  EXPECT_GT(static_cast<double>(covered) / kTrials, 0.91);  // 0.9225: ten blocks do not tell their own spread well
  EXPECT_LT(static_cast<double>(covered_as_if_alike) / kTrials, 0.80);
}

}  // namespace
}  // namespace rigcal
