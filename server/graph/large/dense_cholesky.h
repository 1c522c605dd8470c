// Cholesky factor of a symmetric block matrix, every block stored; left-looking, so that it can be renewed from a
// column on.
#pragma once

#include <algorithm>
#include <vector>

#include "server/graph/large/block_matrix.h"
#include "server/graph/large/lane_kernels.h"

namespace rigcal::graph {

template <int B>
class DenseCholesky final : public BlockCholesky<B> {
 public:
  using typename BlockCholesky<B>::Block;

  // Reads `pattern` as long as it lives; blocks off the diagonal may be added between calls.
  explicit DenseCholesky(const BlockPattern& pattern)
      : count_(pattern.block_count),
        pattern_(pattern),
        rows_((B * count_ + kPanel - 1) / kPanel * kPanel),
        L_(static_cast<std::size_t>((rows_ + kLanes) * rows_)) {}

  bool Factor(const BlockMatrix<B>& matrix, double lambda) override { return FactorFrom(0, matrix, lambda); }

  // Factor() where the block columns before `first` of `matrix` are those of the call before.
  [[nodiscard]] bool FactorFrom(Eigen::Index first, const BlockMatrix<B>& matrix, double lambda) {
    const Eigen::Index panel = B * first / kPanel;
    Write(panel * kPanel / B, matrix, lambda);
    return Kernels().Factor(View(), panel);
  }

  void SolveInPlace(Eigen::Ref<Eigen::MatrixXd> rhs) override {
    x_.resize(rows_ + kLanes);
    for (Eigen::Index column = 0; column < rhs.cols(); ++column) {
      x_.tail(x_.size() - B * count_).setZero();
      x_.head(B * count_) = rhs.col(column);
      Kernels().Solve(View(), x_.data());
      rhs.col(column) = x_.head(B * count_);
    }
  }

  std::vector<Block> InverseDiagonal() override {
    constexpr Eigen::Index kWidth = 2 * kLanes;
    std::vector<Block> blocks(static_cast<std::size_t>(count_));
    Eigen::Matrix<double, kWidth, Eigen::Dynamic> columns(kWidth, rows_);  // of L^-1, as rows
    for (Eigen::Index c = 0; c < count_; ++c) {
      const Eigen::Index begin = B * c / 3 * 3;
      Kernels().InverseColumns(View(), begin, columns.data());
      const auto rows = columns.template middleRows<B>(B * c - begin).leftCols(rows_ - begin);
      blocks[static_cast<std::size_t>(c)] = rows.lazyProduct(rows.transpose());
    }
    return blocks;
  }

 private:
  [[nodiscard]] Triangle View() { return {L_.data(), rows_, rows_ + kLanes}; }
  [[nodiscard]] double& At(Eigen::Index row, Eigen::Index col) {
    return L_[static_cast<std::size_t>(col * (rows_ + kLanes) + row)];
  }
  [[nodiscard]] auto BlockAt(Eigen::Index row, Eigen::Index col) {
    return Eigen::Map<Block, 0, Eigen::OuterStride<>>(&At(B * row, B * col), Eigen::OuterStride<>(rows_ + kLanes));
  }

  void Write(Eigen::Index first, const BlockMatrix<B>& matrix, double lambda) {
    for (Eigen::Index c = first; c < count_; ++c) {
      for (Eigen::Index q = B * c; q < B * (c + 1); ++q) std::fill(&At(q, q), &At(q, q) + (rows_ - q), 0.0);
      BlockAt(c, c) = matrix.diagonal[static_cast<std::size_t>(c)];
      if (lambda > 0.0) BlockAt(c, c).diagonal() *= 1.0 + lambda;
    }
    for (std::size_t s = 0; s < pattern_.off_diagonal.size(); ++s) {
      const auto [row, col] = pattern_.off_diagonal[s];
      if (col >= first) BlockAt(row, col) = matrix.off_diagonal[s];
    }
    for (Eigen::Index k = B * count_; k < rows_; ++k) {  // what fills the last panel
      std::fill(&At(k, k), &At(k, k) + (rows_ - k), 0.0);
      At(k, k) = 1.0;
    }
  }

  Eigen::Index count_;
  const BlockPattern& pattern_;
  Eigen::Index rows_;
  std::vector<double> L_;  // see Triangle
  Eigen::VectorXd x_;      // one right-hand side
};

}  // namespace rigcal::graph
