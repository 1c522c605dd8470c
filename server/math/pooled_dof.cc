#include "server/math/pooled_dof.h"

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

void PooledDof::Add(const Matrix6d& part, int dof) {
  const auto entries = part.reshaped();
  wishart_ += entries * entries.transpose() / dof;
}

void PooledDof::AddBlocks(const Eigen::Matrix<double, 6, Eigen::Dynamic>& columns, int dof) {
  Eigen::Matrix<double, 36, Eigen::Dynamic> terms(36, columns.cols());
  for (Eigen::Index b = 0; b < columns.cols(); ++b)
    terms.col(b) = Matrix6d(columns.col(b) * columns.col(b).transpose()).reshaped();
  const Matrix6d part = columns * columns.transpose();
  const auto entries = part.reshaped();
  Add(part, dof);
  terms_ += static_cast<double>(columns.cols()) / dof * (terms * terms.transpose());
  sums_ += entries * entries.transpose() / dof;
}

// A sum of m terms S_b scatters by m/(m-1) [sum |S_b|^2 - |sum S_b|^2 / m], where of one block tr(S W S W) = tr(S W)^2.
// Where blocks are normal and carry alike that is Wishart's, tr(S W)^2 + tr(S W S W) over m - 1.
double PooledDof::Of(const Matrix6d& sum) const {
  const ObservableSubspace inverse = Observable(sum);
  const Matrix6d& W = inverse.covariance;
  const double wishart = SquaresOfTraces(wishart_, W) + TracesOfSquares(wishart_, W);
  const double of_blocks = SquaresOfTraces(sums_, W) + TracesOfSquares(sums_, W);
  const double uneven = SquaresOfTraces(terms_, W) - TracesOfSquares(sums_, W);
  const double scatter = wishart + std::max(0.0, uneven - of_blocks);
  return scatter > 0.0 ? inverse.rank * (inverse.rank + 1) / scatter : 0.0;
}

}  // namespace rigcal
