#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

#include "server/math/covariance.h"

namespace rigcal {
namespace {

using Eigen::Vector3d;

Matrix6d Diagonal(double x, double y, double z, double rx, double ry, double rz) {
  Vector6d diagonal;
  diagonal << x, y, z, rx, ry, rz;
  return diagonal.asDiagonal();
}

TEST(Observable, FullRankIsTheInverse) {
  Matrix6d Omega = Diagonal(1e4, 2e4, 3e4, 1e7, 2e7, 3e7);
  Omega(0, 4) = Omega(4, 0) = 1e5;
  const ObservableSubspace result = Observable(Omega);
  EXPECT_EQ(result.rank, 6);
  EXPECT_EQ(result.unobservable_basis.cols(), 0);
  EXPECT_LT((result.covariance * Omega - Matrix6d::Identity()).norm(), 1e-12);
}

TEST(Observable, AnUnknownAxisIsTheBasis) {
  const ObservableSubspace result = Observable(Diagonal(1e4, 1e4, 0, 1e6, 1e6, 1e6));
  EXPECT_EQ(result.rank, 5);
  ASSERT_EQ(result.unobservable_basis.cols(), 1);
  EXPECT_LT((result.unobservable_basis.col(0).cwiseAbs() - Vector6d::Unit(tangent::kZ)).norm(), 1e-12);
  EXPECT_LT((result.covariance - Matrix6d(Diagonal(1e-4, 1e-4, 0, 1e-6, 1e-6, 1e-6))).norm(), 1e-15);
}

// A rotation of 90 degrees leaves 1e-17s where zeros belong: they are not information.
TEST(Observable, RoundingNoiseOfAChangeOfFrameIsNotInformation) {
  const Se3 T_a_b{Vector3d(1, 2, 3), Eigen::Quaterniond(Eigen::AngleAxisd(M_PI / 2, Vector3d::UnitZ()))};
  for (int axis = 0; axis < 3; ++axis) {
    Matrix6d Omega = Diagonal(1e6, 1e6, 1e6, 1e8, 1e8, 1e8);
    Omega(axis, axis) = 0.0;
    EXPECT_EQ(Observable(InverseInformation(T_a_b, Omega)).rank, 5) << axis;
  }
}

// Only the sum of z and 2 m * rx is measured: rank 1, and what is left unknown includes their difference.
TEST(Observable, AnObliqueDirection) {
  Vector6d measured = Vector6d::Zero();
  measured(tangent::kZ) = 1.0, measured(tangent::kRx) = 2.0;
  const Matrix6d Omega = 50.0 * measured * measured.transpose();
  const ObservableSubspace result = Observable(Omega);
  EXPECT_EQ(result.rank, 1);
  ASSERT_EQ(result.unobservable_basis.cols(), 5);
  EXPECT_LT((Omega * result.unobservable_basis).norm(), 1e-12);
  const auto gram = result.unobservable_basis.transpose() * result.unobservable_basis;
  EXPECT_LT((gram - Eigen::Matrix<double, 5, 5>::Identity()).norm(), 1e-12);
  EXPECT_LT((Omega * result.covariance * Omega - Omega).norm(), 1e-9);
  EXPECT_LT((result.covariance * result.unobservable_basis).norm(), 1e-12);
}

// A micrometre beside a degree: 1e12 against 3e3 are of different units, not of different rank.
TEST(Observable, UnitsDoNotCostRank) { EXPECT_EQ(Observable(Diagonal(1e12, 1e12, 1e12, 1e-3, 1e-3, 1e-3)).rank, 6); }

TEST(Observable, NothingIsNothing) {
  Matrix6d not_a_number = Matrix6d::Identity();
  not_a_number(2, 3) = std::numeric_limits<double>::quiet_NaN();
  for (const Matrix6d& Omega : {Matrix6d(Matrix6d::Zero()), not_a_number, Matrix6d(1e-300 * Matrix6d::Identity())}) {
    const ObservableSubspace result = Observable(Omega);
    EXPECT_EQ(result.rank, 0);
    EXPECT_EQ(result.unobservable_basis.cols(), 6);
    EXPECT_EQ(result.covariance, Matrix6d::Zero());
  }
}

// Two directions of mixed units: what is left has nothing along them, and the rest as it was.
TEST(CovarianceAcross, KeepsWhatIsAtRightAnglesToWhatIsOpen) {
  const Matrix6d C = Diagonal(1e-6, 2e-6, 3e-6, 4e-6, 5e-6, 6e-6);
  Eigen::Matrix<double, 6, Eigen::Dynamic> open(6, 2);
  open.col(0) = Vector6d::Unit(tangent::kZ);
  open.col(1) = Vector6d::Unit(tangent::kRz) + 0.3 * Vector6d::Unit(tangent::kX);
  const Matrix6d across = CovarianceAcross(C, open);
  EXPECT_LT((across * open).norm(), 1e-20);
  Vector6d seen = Vector6d::Unit(tangent::kX) - 0.3 * Vector6d::Unit(tangent::kRz);
  for (const Vector6d& direction :
       {seen, Vector6d(Vector6d::Unit(tangent::kY)), Vector6d(Vector6d::Unit(tangent::kRx))})
    EXPECT_NEAR(direction.dot(across * direction), direction.dot(C * direction), 1e-18);
  EXPECT_EQ(CovarianceAcross(C, open.leftCols(0)), C);
}

TEST(IsPositiveSemidefinite, Judges) {
  EXPECT_TRUE(IsPositiveSemidefinite(Matrix6d::Zero()));
  EXPECT_TRUE(IsPositiveSemidefinite(Diagonal(1, 1, 0, 1, 1, 1)));
  EXPECT_TRUE(IsPositiveSemidefinite(Diagonal(1, 1, -1e-10, 1, 1, 1)));
  EXPECT_FALSE(IsPositiveSemidefinite(Diagonal(1, 1, -1e-8, 1, 1, 1)));
  EXPECT_FALSE(IsPositiveSemidefinite(-Matrix6d::Identity()));
  Matrix6d asymmetric = Matrix6d::Identity();
  asymmetric(0, 1) = 1e-8;
  EXPECT_FALSE(IsPositiveSemidefinite(asymmetric));
  EXPECT_TRUE(IsPositiveSemidefinite(Symmetrized(asymmetric)));
  Matrix6d infinite = Matrix6d::Identity();
  infinite(5, 5) = std::numeric_limits<double>::infinity();
  EXPECT_FALSE(IsPositiveSemidefinite(infinite));
}

// 10 um beside 1 rad: a correlation of 1.1 between two rotations is wrong however large the other entries are.
TEST(IsPositiveSemidefinite, MetresDoNotHideTheRadians) {
  Matrix6d Omega = Diagonal(1e10, 1e10, 1e10, 1, 1, 1);
  EXPECT_TRUE(IsPositiveSemidefinite(Omega));
  Omega(3, 4) = Omega(4, 3) = 1.1;
  EXPECT_FALSE(IsPositiveSemidefinite(Omega));
  Omega(3, 4) = Omega(4, 3) = 1.0 + 1e-3;
  EXPECT_FALSE(IsPositiveSemidefinite(Omega));
  Omega(3, 4) = Omega(4, 3) = 1.0;
  EXPECT_TRUE(IsPositiveSemidefinite(Omega));
  Omega(3, 4) = 1.0, Omega(4, 3) = 0.5;
  EXPECT_FALSE(IsPositiveSemidefinite(Omega));
}

// A change of frame leaves rounding noise where nothing is known; that is no wrong matrix.
TEST(IsPositiveSemidefinite, ForgivesRoundingAfterChangesOfFrame) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> uniform(-2.0, 2.0);
  for (int k = 0; k < 500; ++k) {
    Vector6d xi;
    for (double& value : xi) value = uniform(random);
    Matrix6d Omega = Matrix6d::Zero();
    for (int axis = 0; axis < 6; ++axis)
      Omega(axis, axis) = (k >> axis) % 2 == 0 ? std::pow(10.0, 8.0 * (axis < 3)) : 0;
    const Matrix6d there = InverseInformation(Se3::Exp(xi), Omega);
    EXPECT_TRUE(IsPositiveSemidefinite(there)) << k;
    EXPECT_TRUE(IsPositiveSemidefinite(InverseInformation(Se3::Exp(xi).Inverse(), there))) << k;
  }
}

}  // namespace
}  // namespace rigcal
