// What chance alone makes of the scan for moves and of the test of a relative pose.
#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <random>

#include "server/calib/joint/misfit/contradicted_pairs.h"
#include "server/calib/joint/misfit/moved_pose.h"

namespace rigcal::calib::joint {
namespace {

constexpr int kGroups = 8, kRows = 12, kOthers = 18, kUnknowns = 6 + kOthers;  // one pose, and what all groups share
constexpr int kDraws = 4000;

// One sensor that is seen in every group, as straight equations r = y + J x with y of unit variance.
class Straight {
 public:
  explicit Straight(unsigned seed) : random_(seed) {
    problem_.sensors = {SensorId("s")};
    refined_.layout.pose = {0};
    refined_.layout.size = kUnknowns;
    Eigen::MatrixXd H = Eigen::MatrixXd::Zero(kUnknowns, kUnknowns);
    for (int g = 0; g < kGroups; ++g) {
      problem_.capture_of_place.push_back(g);
      problem_.corners.emplace_back();
      problem_.corners.back().sensor = 0, problem_.corners.back().place = g;
      refined_.groups.group_of_place.push_back(g);
      J_.push_back(Drawn(kRows, kUnknowns));
      H += J_.back().transpose() * J_.back();
    }
    refined_.covariance = H.inverse();
    refined_.at_optimum.total.H = H;
  }

  // Odds of the likeliest move where nothing moved.
  double Odds() {
    std::vector<Eigen::VectorXd> y;
    Eigen::VectorXd b = Eigen::VectorXd::Zero(kUnknowns);
    for (const Eigen::MatrixXd& J : J_) {
      y.emplace_back(Drawn(kRows, 1));
      b += J.transpose() * y.back();
    }
    const Eigen::VectorXd x = -refined_.covariance * b;
    refined_.at_optimum.groups.clear();
    for (std::size_t g = 0; g < J_.size(); ++g)
      refined_.at_optimum.groups.push_back({J_[g].transpose() * J_[g], J_[g].transpose() * (y[g] + J_[g] * x)});
    const std::vector<Move> moves = ScanForMoves(problem_, refined_);
    return moves.empty() ? 1.0 : moves.front().odds;
  }

 private:
  Eigen::MatrixXd Drawn(int rows, int columns) {
    return Eigen::MatrixXd::NullaryExpr(rows, columns, [&] { return normal_(random_); });
  }

  std::mt19937 random_;
  std::normal_distribution<double> normal_;
  SessionProblem problem_;
  Refined refined_;
  std::vector<Eigen::MatrixXd> J_;
};

// Lenses and boards that all groups share take up most of what one sensor's scores could scatter by.
TEST(JointChance, TheScanNamesNoMoveMoreOftenThanItsOddsSay) {
  Straight straight(1);
  int below_5_percent = 0, below_1_percent = 0;
  for (int draw = 0; draw < kDraws; ++draw) {
    const double odds = straight.Odds();
    below_5_percent += odds < 0.05 ? 1 : 0;
    below_1_percent += odds < 0.01 ? 1 : 0;
  }
  EXPECT_LT(below_5_percent, 0.05 * kDraws);
  EXPECT_LT(below_1_percent, 0.01 * kDraws);
  EXPECT_GT(below_5_percent, 0.002 * kDraws);  // corrected for looks that are much alike
}

Matrix6d RootOf(const Matrix6d& A) { return Eigen::SelfAdjointEigenSolver<Matrix6d>(A).operatorSqrt(); }

// A leverage whose last axis nothing else tells.
TEST(JointChance, OddsOfARelativePoseAreThoseOfChanceWhateverLensesMayDo) {
  std::mt19937 random(2);
  std::normal_distribution<double> normal;
  const auto drawn = [&] { return Vector6d(Vector6d::NullaryExpr([&] { return normal(random); })); };
  const Matrix6d Q =
      Eigen::MatrixXd(Matrix6d::NullaryExpr([&] { return normal(random); })).householderQr().householderQ();
  const Matrix6d leverage = Q * (Vector6d() << 0.1, 0.3, 0.5, 0.7, 0.9, 1.0).finished().asDiagonal() * Q.transpose();
  for (const double by_lenses : {0.0, 0.5, 5.0}) {
    const Matrix6d beside = by_lenses * Matrix6d::Identity();
    const Matrix6d root = RootOf(Matrix6d::Identity() - leverage + 1e-15 * Matrix6d::Identity());
    int below = 0;
    for (int draw = 0; draw < kDraws; ++draw)
      below += OddsOfResidual(root * drawn() + std::sqrt(by_lenses) * drawn(), leverage, beside, 0) < 0.05 ? 1 : 0;
    EXPECT_NEAR(below, 0.05 * kDraws, 45) << by_lenses;  // 3 sigmas
  }
}

TEST(JointChance, WhatNothingElseTellsIsNotJudged) {
  EXPECT_EQ(OddsOfResidual(Vector6d::Constant(100), Matrix6d::Identity(), Matrix6d::Zero(), 0), 1.0);
}

}  // namespace
}  // namespace rigcal::calib::joint
