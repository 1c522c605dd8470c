// How covariances and information matrices of poses change frame (design: conventions). Right perturbation throughout.
#pragma once

#include <Eigen/Core>
#include <cmath>
#include <optional>

#include "server/math/se3.h"

namespace rigcal {

// C_ba = Ad(T_ab) C_ab Ad(T_ab)^T.
[[nodiscard]] Matrix6d InverseCovariance(const Se3& T_a_b, const Matrix6d& C_ab);
// Omega_ba = Ad(T_ab)^-T Omega_ab Ad(T_ab)^-1.
[[nodiscard]] Matrix6d InverseInformation(const Se3& T_a_b, const Matrix6d& Omega_ab);
// C_ac = Ad(T_bc^-1) C_ab Ad(T_bc^-1)^T + C_bc; errors independent.
[[nodiscard]] Matrix6d ComposeCovariance(const Matrix6d& C_ab, const Se3& T_b_c, const Matrix6d& C_bc);
// Covariance of T_A_B = T_ref_A^-1 T_ref_B from the joint covariance of both poses:
// M = Ad(T_AB^-1), C = M C_AA M^T + C_BB - M C_AB - C_BA M^T, with C_AB = E[xi_A xi_B^T].
[[nodiscard]] Matrix6d RelativeCovariance(const Se3& T_A_B, const Matrix6d& C_AA, const Matrix6d& C_BB,
                                          const Matrix6d& C_AB);

// What a positive semi-definite information matrix says and does not say.
struct ObservableSubspace {
  int rank = 0;
  Matrix6d covariance = Matrix6d::Zero();                       // pseudo-inverse: zero on the unobservable rest
  Eigen::Matrix<double, 6, Eigen::Dynamic> unobservable_basis;  // 6 x (6 - rank), orthonormal columns
};
// Eigen-decomposition after scaling rows and columns to unit diagonal (m against rad); an eigenvalue below
// `relative_tolerance` times the largest counts as zero.
[[nodiscard]] ObservableSubspace Observable(const Matrix6d& Omega, double relative_tolerance = 1e-12);
// Covariance of what lies at right angles to the columns of `open` (any number, independent), in m and rad: nothing
// along these. Right where nothing but a motion along them was held while it was worked out.
[[nodiscard]] Matrix6d CovarianceAcross(const Matrix6d& covariance,
                                        const Eigen::Matrix<double, 6, Eigen::Dynamic>& open);
// Finite, symmetric to 1e-9 and smallest eigenvalue >= -1e-9 of the largest, both judged with rows and columns scaled
// to unit diagonal, so that metres do not hide what is wrong with the radians. Rounding noise, 1e-14 of the largest
// entry, is forgiven.
[[nodiscard]] bool IsPositiveSemidefinite(const Matrix6d& Omega);
[[nodiscard]] Matrix6d Symmetrized(const Matrix6d& matrix);
// 1 / sqrt of the diagonal: by which rows and columns of mixed units come to a unit diagonal. 1 where it is not
// positive.
template <typename Matrix>
[[nodiscard]] Eigen::Matrix<double, Matrix::RowsAtCompileTime, 1, 0, Matrix::MaxRowsAtCompileTime, 1> UnitDiagonal(
    const Matrix& H) {
  return H.diagonal().unaryExpr([](double h) { return h > 0 ? 1 / std::sqrt(h) : 1.0; });
}
// H^-1, scaled to a unit diagonal on the way. Nothing where H is empty, or not clearly positive definite.
[[nodiscard]] std::optional<Eigen::MatrixXd> InverseOfDefinite(const Eigen::MatrixXd& H);
// F with F F^T = matrix, for positive semi-definite matrices of mixed units.
[[nodiscard]] Matrix6d SquareRoot(const Matrix6d& matrix);

}  // namespace rigcal
