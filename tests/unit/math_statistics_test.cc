#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <random>

#include "server/math/covariance.h"
#include "server/math/jackknife.h"
#include "server/math/statistics.h"

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

TEST(ShrinkTowardsModel, WeighsByBlocks) {
  const Matrix6d one = Matrix6d::Identity(), two = 2.0 * one;
  EXPECT_LT((ShrinkTowardsModel(one, two, 8).C - 1.5 * one).norm(), 1e-15);  // (7 * 1 + 7 * 2) / 14
  EXPECT_LT((ShrinkTowardsModel(one, two, 1).C - two).norm(), 1e-15);
  EXPECT_DOUBLE_EQ(ShrinkTowardsModel(one, two, 8).jackknife_ratio, 0.5);
  EXPECT_DOUBLE_EQ(JackknifeRatioMax(40), 39.0 / 46.0);
}

TEST(ShrinkTowardsModel, TrustsAModelThatTheBlocksConfirm) {
  const Matrix6d model = Matrix6d::Identity();
  const auto ratio = [&](const Matrix6d& C_jack) { return ShrinkTowardsModel(C_jack, model, 40).jackknife_ratio; };
  EXPECT_LT(ratio(model), 0.6);  // not below 1/2
  EXPECT_GT(ratio(model), 0.5);
  Matrix6d one_off = model;
  one_off(2, 2) = 30.0;
  for (const Matrix6d& contradicted : {Matrix6d(0.1 * model), one_off}) {
    EXPECT_GT(ratio(contradicted), JackknifeRatioMax(40) - 0.02);
    EXPECT_LE(ratio(contradicted), JackknifeRatioMax(40));
  }
  const double sigma_beside = std::sqrt(ShrinkTowardsModel(one_off, model, 40).C(0, 0));
  EXPECT_GT(sigma_beside, 1.0);
  EXPECT_LT(sigma_beside, 1.4);
}

// Only its size is off, and of that the blocks know enough; too wide a model is left as it is.
TEST(ShrinkTowardsModel, WidensAModelThatIsTooSure) {
  const Matrix6d one = Matrix6d::Identity();
  EXPECT_LT((ShrinkTowardsModel(9.0 * one, one, 20).C - 9.0 * one).norm(), 1e-12);
  const auto [C, ratio] = ShrinkTowardsModel(one, 9.0 * one, 20);
  EXPECT_LT((C - (ratio + (1.0 - ratio) * 9.0) * one).norm(), 1e-12);
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
  const ShrunkCovariance here = ShrinkTowardsModel(C_jack, C_model, 31);
  Vector6d units;
  units << 1e-3, 1e-3, 1e-3, 1e-5, 1e-5, 1e-5;
  Vector6d turn;
  turn << 0.5, -1, 2, 0.3, 0.2, -0.4;
  const Matrix6d A = Matrix6d(units.asDiagonal()) * Adjoint(Se3::Exp(turn));
  const auto moved =
      ShrinkTowardsModel(Symmetrized(A * C_jack * A.transpose()), Symmetrized(A * C_model * A.transpose()), 31);
  EXPECT_NEAR(moved.jackknife_ratio, here.jackknife_ratio, 1e-9);
  const Matrix6d expected = A * here.C * A.transpose();
  EXPECT_LT((moved.C - expected).norm(), 1e-9 * expected.norm());
}

MatrixXd WishartOf(const MatrixXd& L, int dof, std::mt19937& random) {
  std::normal_distribution<double> normal;
  MatrixXd W = MatrixXd::Zero(L.rows(), L.rows());
  VectorXd z(L.rows());
  for (int i = 0; i < dof; ++i) {
    for (double& value : z) value = normal(random);
    const VectorXd x = L * z;
    W += x * x.transpose();
  }
  return W;
}

// Mean of err^2 over variance that errors with covariance Sigma have, by thirds of how unlike the model C_jack is.
// Sigma scatters around the model as assumed, but the model is told `size` times as large; along the first p
// directions.
struct Told {
  std::array<double, 3> thirds{};
  double by_seven = 0.0;
};
Told ToldOf(int p, double size) {
  constexpr int kDraws = 3000, kBlocks = 40;
  std::mt19937 random(11);
  std::uniform_real_distribution<double> even;
  Matrix6d C_model = Matrix6d::Zero();
  C_model.topLeftCorner(p, p).diagonal().setConstant(size);
  std::vector<std::pair<double, double>> drawn;
  Told told;
  for (int i = 0; i < kDraws; ++i) {
    const int kappa = static_cast<int>(std::lround(7.0 * std::pow(39.0 / 7.0, even(random))));
    const MatrixXd Sigma = (WishartOf(MatrixXd::Identity(p, p), kappa + p + 1, random) / kappa).inverse();
    const MatrixXd jack = WishartOf(Sigma.llt().matrixL(), kBlocks - 1, random) / (kBlocks - 1);
    Matrix6d C_jack = Matrix6d::Zero();
    C_jack.topLeftCorner(p, p) = jack;
    const MatrixXd C = ShrinkTowardsModel(C_jack, C_model, kBlocks).C.topLeftCorner(p, p);
    const double unlike = jack.selfadjointView<Eigen::Lower>().eigenvalues().array().log().square().sum();
    drawn.emplace_back(unlike, (C.inverse() * Sigma).trace() / p);
    const double seven = JackknifeRatioMax(kBlocks);
    const MatrixXd C_seven = seven * jack + (1.0 - seven) * C_model.topLeftCorner(p, p);
    told.by_seven += (C_seven.inverse() * Sigma).trace() / (p * kDraws);
  }
  std::sort(drawn.begin(), drawn.end());
  for (std::size_t i = 0; i < kDraws; ++i) told.thirds[3 * i / kDraws] += drawn[i].second * 3 / kDraws;
  return told;
}

// Errors are as large as told, in all directions and however the blocks scatter. A model that is right may be taken for
// too sure by chance, which widens it by a little; of one that is too sure by 2 a weight of seven blocks leaves too
// much.
TEST(ShrinkTowardsModel, IsThePosteriorMean) {
  const Told right = ToldOf(6, 1.0), too_sure = ToldOf(5, 0.25);
  for (const double third : right.thirds) EXPECT_NEAR(third, 0.975, 0.025);
  for (const double third : too_sure.thirds) EXPECT_NEAR(third, 1.0, 0.03);
  EXPECT_GT(right.by_seven, 1.04);
  EXPECT_GT(too_sure.by_seven, 1.2);
}

}  // namespace
}  // namespace rigcal
