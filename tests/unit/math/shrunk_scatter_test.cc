// Groups of captures are drawn whose scatter is known, of which one sensor may have more than its model says.
#include "server/math/shrunk_scatter.h"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <random>

namespace rigcal {
namespace {

constexpr int kSensors = 8, kGroups = 10, kRows = 6 * kSensors;

// Sensors that share a reference err alike in part: 0.3 of each variance is in common with all others.
Eigen::MatrixXd Model() {
  const Eigen::MatrixXd alike = Eigen::MatrixXd::Ones(kSensors, kSensors);
  Eigen::MatrixXd model = Eigen::MatrixXd::Zero(kRows, kRows);
  for (int s = 0; s < kSensors; ++s)
    for (int t = 0; t < kSensors; ++t)
      model.block<6, 6>(6 * s, 6 * t) = (s == t ? 1.0 : 0.3) * alike(s, t) * Eigen::Matrix<double, 6, 6>::Identity();
  return model;
}

// Mean, over draws, of the variance told of each sensor over the true one.
Eigen::VectorXd ToldOverTrue(const Eigen::VectorXd& factors, int draws) {
  const Eigen::MatrixXd model = Model(), L = model.llt().matrixL();
  const Eigen::VectorXd more = factors.cwiseSqrt().transpose().replicate(6, 1).reshaped();
  const Eigen::MatrixXd root = more.asDiagonal() * L;  // of the true covariance
  std::mt19937 generator(1);
  std::normal_distribution<double> normal;
  Eigen::VectorXd told = Eigen::VectorXd::Zero(kSensors);
  for (int draw = 0; draw < draws; ++draw) {
    Eigen::MatrixXd moved(kRows, kGroups);
    for (double& number : moved.reshaped()) number = normal(generator) / std::sqrt(kGroups);
    const Eigen::MatrixXd y = L.triangularView<Eigen::Lower>().solve(root * moved);
    const Eigen::MatrixXd covariance = L * ShrinkScatterOfPoses(y, L).S * L.transpose();
    for (int s = 0; s < kSensors; ++s) told[s] += covariance.block<6, 6>(6 * s, 6 * s).trace() / 6 / factors[s] / draws;
  }
  return told;
}

TEST(ShrunkScatter, OfSensorsThatScatterAsTheModelSaysIsTheModels) {
  const Eigen::VectorXd told = ToldOverTrue(Eigen::VectorXd::Ones(kSensors), 60);
  for (const double ratio : told) EXPECT_NEAR(ratio, 1.03, 0.05);
}

// A shape that chance makes is not believed: what is above the model in it would be kept, what is below it not.
TEST(ShrunkScatter, WhatChanceMakesWidensLittle) {
  EXPECT_LT(ToldOverTrue(Eigen::VectorXd::Ones(kSensors), 60).mean(), 1.05);
}

// Drawn together with all others it would be told as 0.4 of what it is.
TEST(ShrunkScatter, OneSensorThatScattersMoreIsToldSoAndNoOther) {
  Eigen::VectorXd factors = Eigen::VectorXd::Ones(kSensors);
  factors[3] = 9.0;
  const Eigen::VectorXd told = ToldOverTrue(factors, 60);
  for (int s = 0; s < kSensors; ++s) {
    EXPECT_GT(told[s], 0.85) << s;
    EXPECT_LT(told[s], 1.30) << s;
  }
}

TEST(ShrunkScatter, OfOneSensorIsThatOfItsOwnGroups) {
  const Eigen::MatrixXd L = Eigen::MatrixXd::Identity(6, 6);
  Eigen::MatrixXd y = Eigen::MatrixXd::Zero(6, 12);
  for (int g = 0; g < 12; ++g) y(g % 6, g) = 2.0;
  const ShrunkScatter shrunk = ShrinkScatterOfPoses(y, L);
  EXPECT_NEAR(shrunk.mean, 8.0, 1e-12);
  EXPECT_LT((shrunk.S - 8 * Eigen::MatrixXd::Identity(6, 6)).norm(), 1e-9);
}

}  // namespace
}  // namespace rigcal
