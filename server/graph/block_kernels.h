// Factors and inverses of small square blocks, column by column so that a column stays in registers.
#pragma once

#include <Eigen/Core>
#include <cmath>

namespace rigcal::graph {

template <int B>
using BlockOf = Eigen::Matrix<double, B, B>;
template <int B>
using BlockColumn = Eigen::Matrix<double, B, 1>;

// The lower triangle of C becomes its Cholesky factor with the *inverses* of the pivots on the diagonal; false if C is
// not positive definite. What is above the diagonal means nothing.
template <int B>
[[nodiscard]] inline bool FactorBlock(BlockOf<B>& C) {
  for (int c = 0; c < B; ++c) {
    BlockColumn<B> column = C.col(c);
    for (int k = 0; k < c; ++k) column -= C.col(k) * C(c, k);
    const double square = column(c);
    if (!(square > 0.0) || !std::isfinite(square)) return false;
    const double inverse = 1.0 / std::sqrt(square);
    column *= inverse;
    column(c) = inverse;
    C.col(c) = column;
  }
  return true;
}

// C <- C * L^-T with L of FactorBlock.
template <int B>
inline void DivideByTransposed(const BlockOf<B>& L, BlockOf<B>& C) {
  for (int c = 0; c < B; ++c) {
    BlockColumn<B> column = C.col(c);
    for (int k = 0; k < c; ++k) column -= C.col(k) * L(c, k);
    C.col(c) = column * L(c, c);
  }
}

// C <- C^-1; false if C is not positive definite.
template <int B>
[[nodiscard]] inline bool InvertBlock(BlockOf<B>& C) {
  if (!FactorBlock<B>(C)) return false;
  BlockOf<B> rows = BlockOf<B>::Identity();  // L^-T
  DivideByTransposed<B>(C, rows);
  C.noalias() = rows * rows.transpose();
  return true;
}

}  // namespace rigcal::graph
