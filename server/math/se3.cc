#include "server/math/se3.h"

#include <Eigen/LU>
#include <Eigen/SVD>
#include <array>
#include <cmath>

namespace rigcal {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

// Below this angle the closed forms lose digits to cancellation; the series below are exact to double precision there.
constexpr double kSeriesBelow_rad = 1.0;

constexpr double Factorial(int n) { return n <= 1 ? 1.0 : n * Factorial(n - 1); }

// c[0] + c[1] x + c[2] x^2 + ...
template <std::size_t N>
double Polynomial(const std::array<double, N>& c, double x) {
  double sum = 0.0;
  for (std::size_t i = N; i-- > 0;) sum = sum * x + c[i];
  return sum;
}

// sin(t/2) / t.
double HalfSineOver(double theta) { return theta < 1e-4 ? 0.5 - theta * theta / 48.0 : std::sin(theta / 2) / theta; }

// (1 - cos t) / t^2, written without cancellation.
double OneMinusCosineOver2(double theta) {
  const double half_sine_over = HalfSineOver(theta);
  return 2.0 * half_sine_over * half_sine_over;
}

// (t - sin t) / t^3.
double ThetaMinusSineOver3(double theta) {
  constexpr std::array<double, 9> kSeries = {1 / Factorial(3),  1 / Factorial(5),  1 / Factorial(7),
                                             1 / Factorial(9),  1 / Factorial(11), 1 / Factorial(13),
                                             1 / Factorial(15), 1 / Factorial(17), 1 / Factorial(19)};
  if (theta < kSeriesBelow_rad) return Polynomial(kSeries, -theta * theta);
  return (theta - std::sin(theta)) / (theta * theta * theta);
}

// (t^2 + 2 cos t - 2) / (2 t^4).
double CosineRestOver4(double theta) {
  constexpr std::array<double, 8> kSeries = {1 / Factorial(4),  1 / Factorial(6),  1 / Factorial(8),
                                             1 / Factorial(10), 1 / Factorial(12), 1 / Factorial(14),
                                             1 / Factorial(16), 1 / Factorial(18)};
  const double theta2 = theta * theta;
  if (theta < kSeriesBelow_rad) return Polynomial(kSeries, -theta2);
  return (theta2 + 2 * std::cos(theta) - 2) / (2 * theta2 * theta2);
}

// (2 t - 3 sin t + t cos t) / (2 t^5).
double SineCosineRestOver5(double theta) {
  constexpr std::array<double, 8> kSeries = {1 / Factorial(5),  2 / Factorial(7),  3 / Factorial(9),
                                             4 / Factorial(11), 5 / Factorial(13), 6 / Factorial(15),
                                             7 / Factorial(17), 8 / Factorial(19)};
  const double theta2 = theta * theta;
  if (theta < kSeriesBelow_rad) return Polynomial(kSeries, -theta2);
  return (2 * theta - 3 * std::sin(theta) + theta * std::cos(theta)) / (2 * theta2 * theta2 * theta);
}

// (1 - t/2 cot(t/2)) / t^2; the series has the Bernoulli numbers |B_2k| / (2k)!.
double HalfCotangentRestOver2(double theta) {
  constexpr std::array<double, 9> kSeries = {
      1 / 6.0 / Factorial(2),  1 / 30.0 / Factorial(4),      1 / 42.0 / Factorial(6),
      1 / 30.0 / Factorial(8), 5 / 66.0 / Factorial(10),     691 / 2730.0 / Factorial(12),
      7 / 6.0 / Factorial(14), 3617 / 510.0 / Factorial(16), 43867 / 798.0 / Factorial(18)};
  if (theta < kSeriesBelow_rad) return Polynomial(kSeries, theta * theta);
  const double half = theta / 2;
  return (1 - half * std::cos(half) / std::sin(half)) / (theta * theta);
}

// The left Jacobian of SO(3), which is also V of SE(3)'s Exp (there by cross products).
Matrix3d LeftJacobianSo3(const Vector3d& phi) {
  const double theta = phi.norm();
  const Matrix3d phi_hat = Hat(phi);
  return Matrix3d::Identity() + OneMinusCosineOver2(theta) * phi_hat + ThetaMinusSineOver3(theta) * phi_hat * phi_hat;
}

Matrix3d LeftJacobianInverseSo3(const Vector3d& phi) {
  const Matrix3d phi_hat = Hat(phi);
  return Matrix3d::Identity() - 0.5 * phi_hat + HalfCotangentRestOver2(phi.norm()) * phi_hat * phi_hat;
}

// Q of Barfoot & Furgale 2014, eq. 102: how a rotation step moves the translation.
Matrix3d LeftJacobianCoupling(const Vector3d& rho, const Vector3d& phi) {
  const double theta = phi.norm();
  const Matrix3d P = Hat(phi);
  const Matrix3d U = Hat(rho);
  const Matrix3d PU = P * U, UP = U * P, PUP = PU * P;
  return 0.5 * U + ThetaMinusSineOver3(theta) * (PU + UP + PUP) + CosineRestOver4(theta) * (P * PU + UP * P - 3 * PUP) +
         SineCosineRestOver5(theta) * (PUP * P + P * PUP);
}

Matrix6d BlockUpperTriangular(const Matrix3d& diagonal, const Matrix3d& upper) {
  Matrix6d matrix;
  matrix << diagonal, upper, Matrix3d::Zero(), diagonal;
  return matrix;
}

Vector3d Translation(const Vector6d& xi) { return xi.segment<3>(tangent::kTranslation); }
Vector3d Rotation(const Vector6d& xi) { return xi.segment<3>(tangent::kRotation); }

bool IsCanonical(const Eigen::Quaterniond& q) {
  for (double part : {q.w(), q.x(), q.y(), q.z()})
    if (part != 0.0) return part > 0.0;
  return true;
}

// q is unit and w >= 0: then atan2 gives [0, pi] with full precision everywhere, pi included.
Vector3d LogSo3(const Eigen::Quaterniond& q) {
  const double sine = q.vec().norm();
  if (sine < 1e-150) return 2.0 * q.vec();
  return 2.0 * std::atan2(sine, q.w()) / sine * q.vec();
}

}  // namespace

Se3 Se3::Exp(const Vector6d& xi) {
  const Vector3d phi = Rotation(xi), rho = Translation(xi);
  const double theta = phi.norm(), half_sine_over = HalfSineOver(theta);
  const Vector3d turned = phi.cross(rho);
  Se3 T;
  T.q.w() = std::cos(theta / 2);
  T.q.vec() = half_sine_over * phi;
  T.p_m = rho + 2.0 * half_sine_over * half_sine_over * turned + ThetaMinusSineOver3(theta) * phi.cross(turned);
  return T;
}

Se3 Se3::FromMatrix(const Eigen::Matrix4d& matrix) {
  const Matrix3d R = matrix.topLeftCorner<3, 3>();
  return Se3{matrix.topRightCorner<3, 1>(), Eigen::Quaterniond(R)}.Normalized();
}

Vector6d Se3::Log() const {
  const Vector3d phi = LogSo3(Normalized().q);
  Vector6d xi;
  xi.segment<3>(tangent::kTranslation) = LeftJacobianInverseSo3(phi) * p_m;
  xi.segment<3>(tangent::kRotation) = phi;
  return xi;
}

Se3 Se3::Inverse() const { return {-(q.conjugate() * p_m), q.conjugate()}; }

Se3 Se3::Normalized() const {
  Eigen::Quaterniond unit = q.normalized();
  if (!IsCanonical(unit)) unit.coeffs() = -unit.coeffs();
  return {p_m, unit};
}

Eigen::Matrix4d Se3::Matrix() const {
  Eigen::Matrix4d matrix = Eigen::Matrix4d::Identity();
  matrix.topLeftCorner<3, 3>() = R();
  matrix.topRightCorner<3, 1>() = p_m;
  return matrix;
}

Se3 operator*(const Se3& T_a_b, const Se3& T_b_c) { return {T_a_b * T_b_c.p_m, T_a_b.q * T_b_c.q}; }
Vector3d operator*(const Se3& T_a_b, const Vector3d& p_b) { return T_a_b.q * p_b + T_a_b.p_m; }

bool AreNear(const Se3& T, const Se3& S, double shift_m, double turn_rad) {
  const Vector6d apart = (T.Inverse() * S).Log();
  return apart.head<3>().norm() < shift_m && apart.tail<3>().norm() < turn_rad;
}

Eigen::Matrix3d NearestRotation(const Eigen::Matrix3d& M) {
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(M, Eigen::ComputeFullU | Eigen::ComputeFullV);
  const Eigen::Vector3d signs(1, 1, (svd.matrixU() * svd.matrixV().transpose()).determinant() < 0 ? -1 : 1);
  return svd.matrixU() * signs.asDiagonal() * svd.matrixV().transpose();
}

Matrix3d Hat(const Vector3d& v) {
  Matrix3d matrix;
  matrix << 0, -v.z(), v.y(), v.z(), 0, -v.x(), -v.y(), v.x(), 0;
  return matrix;
}

Matrix6d Adjoint(const Se3& T) {
  const Matrix3d R = T.R();
  return BlockUpperTriangular(R, Hat(T.p_m) * R);
}

// The right Jacobian is the left one at -xi.
Matrix6d RightJacobian(const Vector6d& xi) {
  return BlockUpperTriangular(LeftJacobianSo3(-Rotation(xi)), LeftJacobianCoupling(-Translation(xi), -Rotation(xi)));
}

Matrix6d RightJacobianInverse(const Vector6d& xi) {
  const Matrix3d J_inverse = LeftJacobianInverseSo3(-Rotation(xi));
  const Matrix3d Q = LeftJacobianCoupling(-Translation(xi), -Rotation(xi));
  return BlockUpperTriangular(J_inverse, -J_inverse * Q * J_inverse);
}

}  // namespace rigcal
