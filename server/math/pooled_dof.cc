#include "server/math/pooled_dof.h"

#include <Eigen/Cholesky>
#include <algorithm>

namespace rigcal {
namespace {

using Products = Eigen::Matrix<double, 36, 36>;

// Sum of tr(S W)^2, of S S^T as vectors.
double SquaresOfTraces(const Products& products, const Matrix6d& W) {
  return W.reshaped().dot(products * W.reshaped());
}

// Sum of tr(S W S W), by W (x) W.
double TracesOfSquares(const Products& products, const Matrix6d& W) {
  double sum = 0.0;
  for (int row = 0; row < 6; ++row)
    for (int col = 0; col < 6; ++col) sum += W(row, col) * products.block<6, 6>(6 * row, 6 * col).cwiseProduct(W).sum();
  return sum;
}

}  // namespace

PooledDof::PooledDof(const Matrix6d& rough) : scale_(Matrix6d::Identity()) {
  const Eigen::LLT<Matrix6d> llt(rough);
  if (llt.info() == Eigen::Success) scale_ = llt.matrixL().solve(Matrix6d::Identity());
}

void PooledDof::Add(const Matrix6d& part, int dof) {
  if (dof <= 0) return;
  const Matrix6d scaled = scale_ * part * scale_.transpose();
  const auto entries = scaled.reshaped();
  others_ += entries * entries.transpose() / dof;
}

// A sum of m terms S_b scatters by m/(m-1) [sum |S_b|^2 - |sum S_b|^2 / m], where of one block tr(S W S W) = tr(S W)^2.
// Where blocks are normal and carry alike that is Wishart's, tr(S W)^2 + tr(S W S W) over m - 1.
void PooledDof::AddBlocks(const Eigen::Matrix<double, 6, Eigen::Dynamic>& columns, int dof) {
  const auto m = static_cast<double>(columns.cols());
  if (dof <= 0 || m < 2) return;
  const Eigen::Matrix<double, 6, Eigen::Dynamic> scaled = scale_ * columns;
  Eigen::Matrix<double, 36, Eigen::Dynamic> terms(36, scaled.cols());
  for (Eigen::Index b = 0; b < scaled.cols(); ++b)
    terms.col(b) = Matrix6d(scaled.col(b) * scaled.col(b).transpose()).reshaped();
  const Matrix6d part = scaled * scaled.transpose();
  const auto entries = part.reshaped();
  const Products product = entries * entries.transpose();
  blocks_ += product / dof;
  terms_ += m / (m - 1) * (terms * terms.transpose());
  sums_ += product / (m - 1);
}

double PooledDof::Of(const Matrix6d& sum) const {
  const ObservableSubspace inverse = Observable(scale_ * sum * scale_.transpose());
  const Matrix6d& W = inverse.covariance;
  const double others = SquaresOfTraces(others_, W) + TracesOfSquares(others_, W);
  const double alike = SquaresOfTraces(blocks_, W) + TracesOfSquares(blocks_, W);
  const double uneven = SquaresOfTraces(terms_, W) - TracesOfSquares(sums_, W);
  const double scatter = others + std::max(alike, uneven);
  return scatter > 0.0 ? inverse.rank * (inverse.rank + 1) / scatter : 0.0;
}

}  // namespace rigcal
