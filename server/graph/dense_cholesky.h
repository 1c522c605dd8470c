// Cholesky factor of a symmetric block matrix, every block stored; left-looking, so that it can be renewed from a
// column on.
#pragma once

#include <vector>

#include "server/graph/block_kernels.h"
#include "server/graph/block_matrix.h"

namespace rigcal::graph {

template <int B>
class DenseCholesky final : public BlockCholesky<B> {
 public:
  using typename BlockCholesky<B>::Block;
  using Column = BlockColumn<B>;

  // Reads `pattern` as long as it lives; blocks off the diagonal may be added between calls.
  explicit DenseCholesky(const BlockPattern& pattern)
      : count_(static_cast<std::size_t>(pattern.block_count)), pattern_(pattern), L_(count_ * (count_ + 1) / 2) {}

  bool Factor(const BlockMatrix<B>& matrix, double lambda) override { return FactorFrom(0, matrix, lambda); }

  // Factor() where the block columns before `first` of `matrix` are those of the call before.
  [[nodiscard]] bool FactorFrom(std::size_t first, const BlockMatrix<B>& matrix, double lambda) {
    Write(first, matrix, lambda);
    for (std::size_t c = first; c < count_; ++c) {
      for (std::size_t k = 0; k < c; ++k) {
        const Block& L_ck = At(c, k);
        for (std::size_t r = c; r < count_; ++r) SubtractProduct<B>(At(r, k), L_ck, At(r, c));
      }
      if (!FactorBlock<B>(At(c, c))) return false;
      for (std::size_t r = c + 1; r < count_; ++r) DivideByTransposed<B>(At(c, c), At(r, c));
    }
    return true;
  }

  void SolveInPlace(Eigen::Ref<Eigen::MatrixXd> rhs) override {
    for (Eigen::Index column = 0; column < rhs.cols(); ++column) SolveColumn(0, &rhs(0, column));
  }

  std::vector<Block> InverseDiagonal() override {
    std::vector<Block> blocks(count_, Block::Zero());
    std::vector<Block> rows(count_);  // of one block column of L^-1, transposed
    for (std::size_t c = 0; c < count_; ++c) {
      for (std::size_t r = c; r < count_; ++r) {
        Block& row = rows[r];
        row.setZero();
        if (r == c) row.setIdentity();
        for (std::size_t k = c; k < r; ++k) SubtractProduct<B>(rows[k], At(r, k), row);
        DivideByTransposed<B>(At(r, r), row);
        for (int q = 0; q < B; ++q)
          for (int p = 0; p < B; ++p) blocks[c].col(q) += row.col(p) * row(q, p);
      }
    }
    return blocks;
  }

 private:
  Block& At(std::size_t row, std::size_t col) { return L_[col * (2 * count_ - col + 1) / 2 + row - col]; }

  void Write(std::size_t first, const BlockMatrix<B>& matrix, double lambda) {
    for (std::size_t c = first; c < count_; ++c) {
      for (std::size_t r = c + 1; r < count_; ++r) At(r, c).setZero();
      At(c, c) = matrix.diagonal[c];
      if (lambda > 0.0) At(c, c).diagonal() *= 1.0 + lambda;
    }
    for (std::size_t s = 0; s < pattern_.off_diagonal.size(); ++s) {
      const auto row = static_cast<std::size_t>(pattern_.off_diagonal[s].row),
                 col = static_cast<std::size_t>(pattern_.off_diagonal[s].col);
      if (col >= first) At(row, col) = matrix.off_diagonal[s];
    }
  }

  void SolveColumn(std::size_t first, double* x) {
    const auto part = [x](std::size_t v) { return Eigen::Map<Column>(x + B * v); };
    for (std::size_t c = first; c < count_; ++c) {
      Column x_c = part(c);
      SolveLower<B>(At(c, c), x_c);
      part(c) = x_c;
      for (std::size_t r = c + 1; r < count_; ++r) {
        Column x_r = part(r);
        for (int k = 0; k < B; ++k) x_r -= At(r, c).col(k) * x_c(k);
        part(r) = x_r;
      }
    }
    for (std::size_t c = count_; c-- > 0;) {
      Block products = Block::Zero();  // summed over their rows once, at the end
      for (std::size_t r = c + 1; r < count_; ++r) {
        const Column x_r = part(r);
        for (int k = 0; k < B; ++k) products.col(k) += At(r, c).col(k).cwiseProduct(x_r);
      }
      Column x_c = part(c);
      x_c -= products.colwise().sum().transpose();
      SolveLowerTransposed<B>(At(c, c), x_c);
      part(c) = x_c;
    }
  }

  std::size_t count_;
  const BlockPattern& pattern_;
  std::vector<Block> L_;  // lower triangle, block column by block column
};

}  // namespace rigcal::graph
