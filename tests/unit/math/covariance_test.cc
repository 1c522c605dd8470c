// Variance on one axis only, looked for at the axis where a person with pencil and paper finds it.
#include "server/math/covariance.h"

#include <gtest/gtest.h>

#include <cmath>

namespace rigcal {
namespace {

using Eigen::Quaterniond;
using Eigen::Vector3d;
using tangent::kRx;
using tangent::kRy;
using tangent::kRz;
using tangent::kX;
using tangent::kY;
using tangent::kZ;

const Quaterniond kQuarterTurnAboutZ(std::sqrt(0.5), 0, 0, std::sqrt(0.5));

Matrix6d OneAxis(int axis, double variance) {
  Matrix6d C = Matrix6d::Zero();
  C(axis, axis) = variance;
  return C;
}

void ExpectNear(const Matrix6d& actual, const Matrix6d& expected) {
  EXPECT_LT((actual - expected).cwiseAbs().maxCoeff(), 1e-14) << "actual\n" << actual << "\nexpected\n" << expected;
}

// b's x axis is a's y axis. b wobbles along its x: seen from b, a wobbles along a's y.
TEST(InverseCovariance, TranslationTurnsWithTheFrame) {
  const Se3 T_a_b{Vector3d(5, 6, 7), kQuarterTurnAboutZ};
  ExpectNear(InverseCovariance(T_a_b, OneAxis(kX, 0.25)), OneAxis(kY, 0.25));
  ExpectNear(InverseCovariance(T_a_b, OneAxis(kY, 0.25)), OneAxis(kX, 0.25));
  ExpectNear(InverseCovariance(T_a_b, OneAxis(kZ, 0.25)), OneAxis(kZ, 0.25));
}

// b sits 2 m above a, turned a quarter about z. b turns by w about its own x, which is a's y. Seen from b, a turns
// about a's y by -w and swings by -w y x (0,0,-2), 2 m times w along +x: variance 4 on x, 1 on ry, covariance -2
// between them.
TEST(InverseCovariance, RotationSwingsTheOtherFrame) {
  const Se3 T_a_b{Vector3d(0, 0, 2), kQuarterTurnAboutZ};
  Matrix6d expected = OneAxis(kRy, 1.0);
  expected(kX, kX) = 4.0;
  expected(kX, kRy) = expected(kRy, kX) = -2.0;
  ExpectNear(InverseCovariance(T_a_b, OneAxis(kRx, 1.0)), expected);
}

TEST(InverseInformation, IsTheInverseOfTheInverse) {
  const Se3 T_a_b{Vector3d(1, -2, 0.5), Quaterniond(0.5, -0.5, 0.5, 0.5)};
  Matrix6d C = Matrix6d::Identity();
  C.diagonal() << 1, 2, 3, 0.1, 0.2, 0.3;
  C(0, 4) = C(4, 0) = 0.2;
  const Matrix6d Omega_ba = InverseInformation(T_a_b, C.inverse());
  EXPECT_LT((Omega_ba * InverseCovariance(T_a_b, C) - Matrix6d::Identity()).norm(), 1e-11);
}

TEST(InverseInformation, KnowledgeOfOneAxisTurnsWithTheFrame) {
  const Se3 T_a_b{Vector3d::Zero(), kQuarterTurnAboutZ};
  ExpectNear(InverseInformation(T_a_b, OneAxis(kX, 9.0)), OneAxis(kY, 9.0));
  ExpectNear(InverseInformation(T_a_b, OneAxis(kRy, 9.0)), OneAxis(kRx, 9.0));
}

// c is 3 m above b. b turns about its x by w: c swings to -3 w in y.
TEST(ComposeCovariance, ALeverTurnsRotationIntoTranslation) {
  const Se3 T_b_c{Vector3d(0, 0, 3), Quaterniond::Identity()};
  Matrix6d expected = OneAxis(kRx, 1.0);
  expected(kY, kY) = 9.0;
  expected(kY, kRx) = expected(kRx, kY) = -3.0;
  ExpectNear(ComposeCovariance(OneAxis(kRx, 1.0), T_b_c, Matrix6d::Zero()), expected);
}

// c's x axis is b's y axis: what wobbles along b's y wobbles along c's x. The second error is c's own already.
TEST(ComposeCovariance, TheFirstErrorIsReadInTheLastFrame) {
  const Se3 T_b_c{Vector3d(1, 1, 1), kQuarterTurnAboutZ};
  ExpectNear(ComposeCovariance(OneAxis(kY, 1.0), T_b_c, Matrix6d::Zero()), OneAxis(kX, 1.0));
  ExpectNear(ComposeCovariance(Matrix6d::Zero(), T_b_c, OneAxis(kRz, 2.0)), OneAxis(kRz, 2.0));
}

// B's x axis is A's y axis, so that A's x is B's -y.
TEST(RelativeCovariance, EachPoseAlone) {
  const Se3 T_A_B{Vector3d::Zero(), kQuarterTurnAboutZ};
  const Matrix6d zero = Matrix6d::Zero();
  ExpectNear(RelativeCovariance(T_A_B, OneAxis(kX, 1.0), zero, zero), OneAxis(kY, 1.0));
  ExpectNear(RelativeCovariance(T_A_B, zero, OneAxis(kX, 1.0), zero), OneAxis(kX, 1.0));
}

// A and B ride on one stage that moves along A's x, which is B's -y: xi_B(y) = -xi_A(x). Between them nothing moves.
TEST(RelativeCovariance, WhatMovesBothAlikeCancels) {
  const Se3 T_A_B{Vector3d(0.4, 0.3, 0.2), kQuarterTurnAboutZ};
  Matrix6d C_AB = Matrix6d::Zero();
  C_AB(kX, kY) = -1.0;
  ExpectNear(RelativeCovariance(T_A_B, OneAxis(kX, 1.0), OneAxis(kY, 1.0), C_AB), Matrix6d::Zero());
}

}  // namespace
}  // namespace rigcal
