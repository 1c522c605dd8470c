#include "server/math/covariance.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/QR>
#include <algorithm>
#include <cmath>

namespace rigcal {
namespace {

using Basis = Eigen::Matrix<double, 6, Eigen::Dynamic>;

// Information below this is none: its inverse would overflow.
constexpr double kInformationMin = 1e-200;

// What counts as symmetric and as not negative: at unit diagonal, and what a change of frame leaves as rounding noise
// where nothing is known, as a share of the largest entry.
constexpr double kIndefiniteRatio = 1e-9, kRoundingRatio = 1e-14, kScaleTolerance = 1e-12;

// Scale per axis that brings the diagonal to 1. An axis that knows next to nothing beside the others of its unit keeps
// their scale: rounding noise of a change of frame must not be blown up into information.
Vector6d UnitDiagonalScale(const Matrix6d& Omega, double relative_tolerance) {
  Vector6d scale;
  for (int start : {tangent::kTranslation, tangent::kRotation}) {
    const double largest = Omega.diagonal().segment<3>(start).maxCoeff();
    for (int i = start; i < start + 3; ++i) {
      const double information = std::max(Omega(i, i), relative_tolerance * largest);
      scale(i) = information > kInformationMin ? 1.0 / std::sqrt(information) : 1.0;
    }
  }
  return scale;
}

// Inverse of a positive definite matrix, scaled to unit diagonal on the way.
Eigen::MatrixXd ScaledInverse(const Eigen::MatrixXd& matrix) {
  const Eigen::VectorXd scale = matrix.diagonal().cwiseSqrt().cwiseInverse();
  const Eigen::MatrixXd scaled = scale.asDiagonal() * matrix * scale.asDiagonal();
  const Eigen::MatrixXd identity = Eigen::MatrixXd::Identity(matrix.rows(), matrix.cols());
  return scale.asDiagonal() * scaled.ldlt().solve(identity) * scale.asDiagonal();
}

// Splits R^6 into an orthonormal basis of span(null_vectors) and one of its complement.
void Split(const Basis& null_vectors, Basis& unobservable, Basis& observable) {
  const Eigen::Index count = null_vectors.cols();
  const Matrix6d Q = Eigen::HouseholderQR<Basis>(null_vectors).householderQ() * Matrix6d::Identity();
  unobservable = Q.leftCols(count);
  observable = Q.rightCols(6 - count);
}

// How many of the ascending eigenvalues count as zero. The scaled matrix has a 1 on its diagonal, hence an eigenvalue
// of at least 1, unless there is no information at all.
int CountZero(const Vector6d& eigenvalues, double relative_tolerance) {
  if (!(eigenvalues(5) > 0.5)) return 6;
  int count = 0;
  while (eigenvalues(count) <= relative_tolerance * eigenvalues(5)) ++count;
  return count;
}

}  // namespace

std::optional<Eigen::MatrixXd> InverseOfDefinite(const Eigen::MatrixXd& H) {
  if (H.rows() == 0 || !(H.diagonal().minCoeff() > 0)) return std::nullopt;
  const Eigen::VectorXd scale = UnitDiagonal(H);
  const Eigen::LLT<Eigen::MatrixXd> llt(scale.asDiagonal() * H * scale.asDiagonal());
  if (llt.info() != Eigen::Success || llt.matrixLLT().diagonal().minCoeff() < 1e-7) return std::nullopt;
  const Eigen::MatrixXd inverse = llt.solve(Eigen::MatrixXd::Identity(H.rows(), H.cols()));
  return Eigen::MatrixXd(scale.asDiagonal() * inverse * scale.asDiagonal());
}

Matrix6d Symmetrized(const Matrix6d& matrix) { return 0.5 * matrix + 0.5 * matrix.transpose(); }

Matrix6d SquareRoot(const Matrix6d& matrix) {
  Vector6d scale;
  for (int k = 0; k < 6; ++k) scale(k) = matrix(k, k) > 0.0 ? std::sqrt(matrix(k, k)) : 1.0;
  const Vector6d inverse = scale.cwiseInverse();
  const Eigen::SelfAdjointEigenSolver<Matrix6d> eigen(inverse.asDiagonal() * matrix * inverse.asDiagonal());
  const Vector6d roots = eigen.eigenvalues().cwiseMax(0.0).cwiseSqrt();
  return scale.asDiagonal() * eigen.eigenvectors() * roots.asDiagonal();
}

Matrix6d InverseCovariance(const Se3& T_a_b, const Matrix6d& C_ab) {
  const Matrix6d A = Adjoint(T_a_b);
  return Symmetrized(A * C_ab * A.transpose());
}

Matrix6d InverseInformation(const Se3& T_a_b, const Matrix6d& Omega_ab) {
  const Matrix6d A_inverse = Adjoint(T_a_b.Inverse());
  return Symmetrized(A_inverse.transpose() * Omega_ab * A_inverse);
}

Matrix6d ComposeCovariance(const Matrix6d& C_ab, const Se3& T_b_c, const Matrix6d& C_bc) {
  const Matrix6d A = Adjoint(T_b_c.Inverse());
  return Symmetrized(A * C_ab * A.transpose() + C_bc);
}

Matrix6d RelativeCovariance(const Se3& T_A_B, const Matrix6d& C_AA, const Matrix6d& C_BB, const Matrix6d& C_AB) {
  const Matrix6d M = Adjoint(T_A_B.Inverse());
  return Symmetrized(M * C_AA * M.transpose() + C_BB - M * C_AB - C_AB.transpose() * M.transpose());
}

ObservableSubspace Observable(const Matrix6d& Omega, double relative_tolerance) {
  ObservableSubspace result;
  result.unobservable_basis = Matrix6d::Identity();
  if (!Omega.allFinite()) return result;
  const Matrix6d symmetric = Symmetrized(Omega);
  const Vector6d scale = UnitDiagonalScale(symmetric, relative_tolerance);
  const Eigen::SelfAdjointEigenSolver<Matrix6d> eigen(scale.asDiagonal() * symmetric * scale.asDiagonal());
  const int unobservable = CountZero(eigen.eigenvalues(), relative_tolerance);
  result.rank = 6 - unobservable;
  if (unobservable == 6) return result;
  Basis observable = Matrix6d::Identity();
  result.unobservable_basis.resize(6, unobservable);
  if (unobservable > 0) {
    const Basis null_vectors = scale.asDiagonal() * eigen.eigenvectors().leftCols(unobservable);
    Split(null_vectors, result.unobservable_basis, observable);
  }
  const Eigen::MatrixXd inverse = ScaledInverse(observable.transpose() * symmetric * observable);
  result.covariance = Symmetrized(observable * inverse * observable.transpose());
  return result;
}

Matrix6d CovarianceAcross(const Matrix6d& covariance, const Basis& open) {
  if (open.cols() == 0) return covariance;
  Basis along, across;
  Split(open, along, across);
  const Matrix6d P = across * across.transpose();
  return Symmetrized(P * covariance * P);
}

bool IsPositiveSemidefinite(const Matrix6d& Omega) {
  if (!Omega.allFinite()) return false;
  const double rounding = kRoundingRatio * Omega.cwiseAbs().maxCoeff();
  Vector6d scale = UnitDiagonalScale(Omega, kScaleTolerance);
  for (int axis = 0; axis < 6; ++axis)  // without information there is no diagonal to bring to 1: its unit's scale
    if (Omega(axis, axis) <= 0.0) scale(axis) = scale.segment<3>(axis < 3 ? 0 : 3).minCoeff();
  const auto scaled = [&scale](const Matrix6d& matrix) -> Matrix6d {
    return scale.asDiagonal() * matrix * scale.asDiagonal();
  };
  const Matrix6d asymmetry = Omega - Omega.transpose();
  const Matrix6d judged = scaled(asymmetry);
  for (int k = 0; k < 36; ++k)
    if (!(std::abs(asymmetry(k)) <= rounding || std::abs(judged(k)) <= kIndefiniteRatio)) return false;
  const Matrix6d symmetric = Symmetrized(Omega);
  const Eigen::SelfAdjointEigenSolver<Matrix6d> eigen(scaled(symmetric));
  if (!eigen.eigenvalues().allFinite()) return false;
  for (int k = 0; k < 6 && eigen.eigenvalues()(k) < -kIndefiniteRatio * std::abs(eigen.eigenvalues()(5)); ++k) {
    const Vector6d direction = (scale.asDiagonal() * eigen.eigenvectors().col(k)).normalized();
    if (!(direction.dot(symmetric * direction) >= -rounding)) return false;
  }
  return true;
}

}  // namespace rigcal
