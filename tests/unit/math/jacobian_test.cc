// Oracle: central differences of Exp and Log.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "server/math/se3.h"

namespace rigcal {
namespace {

Vector6d AwayFromZero(double angle_rad) {
  Vector6d xi;
  xi << 0.7, -1.1, 0.4, 0.48, -0.6, 0.64;
  xi.tail<3>() *= angle_rad;
  return xi;
}

Vector6d Step(int axis, double size) { return size * Vector6d::Unit(axis); }

// d/ds Log(Exp(xi)^-1 Exp(xi + s e_axis)).
Matrix6d NumericRightJacobian(const Vector6d& xi, double step) {
  Matrix6d jacobian;
  const Se3 inverse = Se3::Exp(xi).Inverse();
  for (int axis = 0; axis < 6; ++axis) {
    const Vector6d ahead = (inverse * Se3::Exp(xi + Step(axis, step))).Log();
    const Vector6d behind = (inverse * Se3::Exp(xi - Step(axis, step))).Log();
    jacobian.col(axis) = (ahead - behind) / (2 * step);
  }
  return jacobian;
}

// d/ds Log(Exp(xi) Exp(s e_axis)).
Matrix6d NumericRightJacobianInverse(const Vector6d& xi, double step) {
  Matrix6d jacobian;
  for (int axis = 0; axis < 6; ++axis) {
    const Vector6d ahead = (Se3::Exp(xi) * Se3::Exp(Step(axis, step))).Log();
    const Vector6d behind = (Se3::Exp(xi) * Se3::Exp(Step(axis, -step))).Log();
    jacobian.col(axis) = (ahead - behind) / (2 * step);
  }
  return jacobian;
}

class JacobianAngles : public ::testing::TestWithParam<double> {};

TEST_P(JacobianAngles, RightJacobianIsTheDerivativeOfExp) {
  const Vector6d xi = AwayFromZero(GetParam());
  EXPECT_LT((RightJacobian(xi) - NumericRightJacobian(xi, 1e-5)).cwiseAbs().maxCoeff(), 1e-9);
}

TEST_P(JacobianAngles, InverseIsTheDerivativeOfLog) {
  const Vector6d xi = AwayFromZero(std::min(GetParam(), 3.1));  // a step across pi would jump
  EXPECT_LT((RightJacobianInverse(xi) - NumericRightJacobianInverse(xi, 1e-5)).cwiseAbs().maxCoeff(), 1e-8);
}

TEST_P(JacobianAngles, InverseInverts) {
  const Vector6d xi = AwayFromZero(GetParam());
  EXPECT_LT((RightJacobianInverse(xi) * RightJacobian(xi) - Matrix6d::Identity()).norm(), 1e-12);
}

INSTANTIATE_TEST_SUITE_P(FromZeroToPi, JacobianAngles,
                         ::testing::Values(0.0, 1e-9, 1e-4, 0.1, 0.7, 0.999, 1.001, 2.0, 3.0, 3.14159265, 4.5));

TEST(Jacobian, SeriesAndClosedFormsMeet) {
  const Vector6d below = AwayFromZero(1.0 - 1e-13), above = AwayFromZero(1.0 + 1e-13);
  EXPECT_LT((RightJacobian(below) - RightJacobian(above)).norm(), 1e-12);
  EXPECT_LT((RightJacobianInverse(below) - RightJacobianInverse(above)).norm(), 1e-12);
  EXPECT_LT((Se3::Exp(below).Matrix() - Se3::Exp(above).Matrix()).norm(), 1e-12);
}

}  // namespace
}  // namespace rigcal
