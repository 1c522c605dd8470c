// Oracles: the matrix exponential of 4x4 matrices (Eigen's, which knows nothing of SE(3)) and cases done by hand.
#include "server/math/se3.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <unsupported/Eigen/MatrixFunctions>

namespace rigcal {
namespace {

using Eigen::Matrix4d;
using Eigen::Quaterniond;
using Eigen::Vector3d;

Matrix4d MatrixExponential(const Vector6d& xi) {
  Matrix4d generator = Matrix4d::Zero();
  generator(0, 1) = -xi(tangent::kRz), generator(1, 0) = xi(tangent::kRz);
  generator(0, 2) = xi(tangent::kRy), generator(2, 0) = -xi(tangent::kRy);
  generator(1, 2) = -xi(tangent::kRx), generator(2, 1) = xi(tangent::kRx);
  generator.topRightCorner<3, 1>() = xi.head<3>();
  return generator.exp();
}

Vector6d RandomTangent(std::mt19937& random, double angle_rad) {
  std::normal_distribution<double> normal;
  Vector6d xi;
  for (double& value : xi) value = normal(random);
  xi.tail<3>() *= angle_rad / xi.tail<3>().norm();
  return xi;
}

Vector6d Tangent(double x, double y, double z, double rx, double ry, double rz) {
  Vector6d xi;
  xi << x, y, z, rx, ry, rz;
  return xi;
}

class Angles : public ::testing::TestWithParam<double> {};

TEST_P(Angles, ExpIsTheMatrixExponential) {
  std::mt19937 random(1);
  for (int i = 0; i < 50; ++i) {
    const Vector6d xi = RandomTangent(random, GetParam());
    EXPECT_LT((Se3::Exp(xi).Matrix() - MatrixExponential(xi)).norm(), 2e-14 * (1 + xi.norm()));
  }
}

TEST_P(Angles, LogUndoesExpTheShorterWayRound) {
  std::mt19937 random(2);
  const double angle = GetParam();
  for (int i = 0; i < 50; ++i) {
    const Vector6d xi = RandomTangent(random, angle);
    const Vector6d back = Se3::Exp(xi).Log();
    EXPECT_LT((MatrixExponential(back) - MatrixExponential(xi)).norm(), 1e-13 * (1 + xi.norm()));
    EXPECT_LE(back.tail<3>().norm(), M_PI);
    if (angle > M_PI) continue;
    EXPECT_LT((back - xi).tail<3>().norm(), 3e-15 * angle);
    EXPECT_LT((back - xi).head<3>().norm(), 2e-14 * xi.norm());
  }
}

TEST_P(Angles, AdjointMovesATangentThroughATransform) {
  std::mt19937 random(3);
  const Matrix4d T = MatrixExponential(RandomTangent(random, 1.9));
  for (int i = 0; i < 50; ++i) {
    const Vector6d xi = RandomTangent(random, GetParam());
    const Matrix4d moved = T * MatrixExponential(xi) * T.inverse();
    EXPECT_LT((moved - MatrixExponential(Adjoint(Se3::FromMatrix(T)) * xi)).norm(), 1e-13 * (1 + xi.norm()));
  }
}

INSTANTIATE_TEST_SUITE_P(FromZeroToBeyondPi, Angles,
                         ::testing::Values(1e-160, 1e-12, 1e-8, 1e-5, 0.99e-4, 1.01e-4, 0.01, 0.5, 0.999999, 1.000001,
                                           2.0, 3.0, 3.14159, M_PI - 1e-9, 4.0, 6.0));

TEST(Se3, ZeroTangentIsTheIdentityExactly) {
  EXPECT_EQ(Se3::Exp(Vector6d::Zero()).Matrix(), Matrix4d::Identity());
  EXPECT_EQ(Se3{}.Log(), Vector6d::Zero());
}

TEST(Se3, LogAtExactlyPi) {
  for (int axis = 0; axis < 3; ++axis) {
    Matrix4d half_turn = -Matrix4d::Identity();
    half_turn(axis, axis) = half_turn(3, 3) = 1.0;
    half_turn.topRightCorner<3, 1>() = Vector3d(0.3, -0.2, 0.1);
    const Vector6d xi = Se3::FromMatrix(half_turn).Log();
    EXPECT_DOUBLE_EQ(xi(tangent::kRotation + axis), M_PI);
    EXPECT_DOUBLE_EQ(xi.tail<3>().norm(), M_PI);
    EXPECT_LT((MatrixExponential(xi) - half_turn).norm(), 1e-14);
  }
}

TEST(Se3, LogAtPiAboutObliqueAxesDoesNotDependOnTheQuaternionsSign) {
  for (const Vector3d& axis : {Vector3d(1, 1, 0), Vector3d(-1, 2, 3), Vector3d(0, 0, -1), Vector3d(0, -1, 1)}) {
    const Vector3d unit = axis.normalized();
    const Se3 T{Vector3d(1, 2, 3), Quaterniond(0.0, unit.x(), unit.y(), unit.z())};
    const Se3 negated{T.p_m, Quaterniond(-0.0, -unit.x(), -unit.y(), -unit.z())};
    const Vector6d xi = T.Log();
    EXPECT_NEAR(xi.tail<3>().norm(), M_PI, 1e-15);
    EXPECT_EQ(xi, negated.Log());
    EXPECT_LT((MatrixExponential(xi) - T.Matrix()).norm(), 1e-13);
  }
}

TEST(Se3, LogTakesTheShorterWay) {
  const Vector6d xi = Se3::Exp(Tangent(0, 0, 0, 0, 0, 4.0)).Log();
  EXPECT_NEAR(xi(tangent::kRz), 4.0 - 2 * M_PI, 1e-15);
}

// A quarter turn left while driving along a circle of radius 1 m ends at (1, 1); an Exp of SO(3) x R^3 would say (pi/2,
// 0).
TEST(Se3, ExpDrivesAlongTheArc) {
  const Se3 T = Se3::Exp(Tangent(M_PI / 2, 0, 0, 0, 0, M_PI / 2));
  EXPECT_LT((T.p_m - Vector3d(1, 1, 0)).norm(), 1e-15);
  EXPECT_LT((T * Vector3d(1, 0, 0) - Vector3d(1, 2, 0)).norm(), 1e-15);
}

// b stands 2 m ahead of a and looks to a's left. What lies 1 m ahead of b is at (2, 1) in a.
TEST(Se3, PointsGoFromTheRightFrameToTheLeft) {
  const Se3 T_a_b{Vector3d(2, 0, 0), Quaterniond(std::sqrt(0.5), 0, 0, std::sqrt(0.5))};
  EXPECT_LT((T_a_b * Vector3d(1, 0, 0) - Vector3d(2, 1, 0)).norm(), 1e-15);
  EXPECT_LT((T_a_b.Inverse() * Vector3d(2, 1, 0) - Vector3d(1, 0, 0)).norm(), 1e-15);
  EXPECT_LT(((T_a_b * T_a_b) * Vector3d(0, 0, 0) - Vector3d(2, 2, 0)).norm(), 1e-15);
}

TEST(Se3, ComposeAndInverseAreThoseOfMatrices) {
  std::mt19937 random(4);
  for (int i = 0; i < 50; ++i) {
    const Se3 A = Se3::Exp(RandomTangent(random, 2.5)), B = Se3::Exp(RandomTangent(random, 1.0));
    EXPECT_LT(((A * B).Matrix() - A.Matrix() * B.Matrix()).norm(), 1e-14);
    EXPECT_LT((A.Inverse().Matrix() - A.Matrix().inverse()).norm(), 1e-14);
  }
}

TEST(Se3, NormalizedHasOneSign) {
  const Se3 T{Vector3d(1, 2, 3), Quaterniond(-2.0, 0.0, 0.0, 0.2)};
  EXPECT_GT(T.Normalized().q.w(), 0.0);
  EXPECT_NEAR(T.Normalized().q.norm(), 1.0, 1e-15);
  EXPECT_EQ(T.Normalized().p_m, T.p_m);
  const Se3 half_turn{Vector3d::Zero(), Quaterniond(0.0, 0.0, -1.0, 0.0)};
  EXPECT_EQ(half_turn.Normalized().q.y(), 1.0);
}

}  // namespace
}  // namespace rigcal
