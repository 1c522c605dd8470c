// Supernodal Cholesky, right-looking: the shape comes from CHOLMOD, the numbers from Eigen's dense kernels on one
// thread. (CHOLMOD's own numeric phase starts OpenMP threads that spin, and its BLAS is chosen by the machine: neither
// is acceptable where the same edges must give the same bytes and many robots are solved side by side.)
#pragma once

#include <Eigen/Cholesky>
#include <algorithm>
#include <utility>
#include <vector>

#include "server/graph/block_matrix.h"
#include "server/graph/selected_inverse.h"
#include "server/graph/supernodes.h"

namespace rigcal::graph {

template <int B>
class SparseCholesky final : public BlockCholesky<B> {
 public:
  using typename BlockCholesky<B>::Block;

  SparseCholesky(const BlockPattern& pattern, Supernodes shape) : pattern_(pattern), shape_(std::move(shape)) {
    values_.resize(shape_.value_start.back());
    place_.assign(static_cast<std::size_t>(shape_.size), -1);
    for (int v = 0; v < pattern.block_count; ++v) diagonal_at_.push_back(Locate(v, v));
    for (const BlockPosition& at : pattern.off_diagonal) off_diagonal_at_.push_back(Locate(at.row, at.col));
    int below_max = 0;
    for (int s = 0; s < shape_.count(); ++s) below_max = std::max(below_max, SliceOf(shape_, s).below());
    update_.resize(static_cast<std::size_t>(below_max) * static_cast<std::size_t>(below_max));
  }

  bool Factor(const BlockMatrix<B>& matrix, double lambda) override {
    std::fill(values_.begin(), values_.end(), 0.0);
    for (std::size_t v = 0; v < diagonal_at_.size(); ++v) Write(diagonal_at_[v], matrix.diagonal[v], 1.0 + lambda);
    for (std::size_t s = 0; s < off_diagonal_at_.size(); ++s) Write(off_diagonal_at_[s], matrix.off_diagonal[s], 1.0);
    for (int s = 0; s < shape_.count(); ++s)
      if (!Eliminate(SliceOf(shape_, s))) return false;
    return true;
  }

  void SolveInPlace(Eigen::Ref<Eigen::MatrixXd> rhs) override {
    work_.resize(rhs.rows(), rhs.cols());
    for (Eigen::Index k = 0; k < rhs.rows(); ++k) work_.row(shape_.position[static_cast<std::size_t>(k)]) = rhs.row(k);
    for (int s = 0; s < shape_.count(); ++s) Forward(s, work_, below_);
    for (int s = shape_.count() - 1; s >= 0; --s) Backward(s, work_, below_);
    for (Eigen::Index k = 0; k < rhs.rows(); ++k) rhs.row(k) = work_.row(shape_.position[static_cast<std::size_t>(k)]);
  }

  std::vector<Block> InverseDiagonal() override {
    const SelectedInverse inverse(shape_, values_);
    std::vector<Block> blocks(static_cast<std::size_t>(pattern_.block_count));
    for (std::size_t v = 0; v < blocks.size(); ++v) {
      const int first = shape_.position[B * v];
      for (int r = 0; r < B; ++r)
        for (int c = 0; c < B; ++c) blocks[v](r, c) = inverse.At(first + r, first + c);
    }
    return blocks;
  }

  [[nodiscard]] const Supernodes& shape() const { return shape_; }

  // One supernode's part of x <- L^-1 x, for x in the factor's order; supernodes ascend. `below` is scratch.
  template <typename Columns>
  void Forward(int s, Columns& x, Columns& below) const {
    const Supernode supernode = SliceOf(shape_, s);
    const Eigen::Map<const Eigen::MatrixXd> L = ValuesOf(supernode);
    auto x_J = x.middleRows(supernode.first_col, supernode.col_count);
    L.topRows(supernode.col_count).template triangularView<Eigen::Lower>().solveInPlace(x_J);
    if (supernode.below() == 0) return;
    below.noalias() = L.bottomRows(supernode.below()) * x_J;
    for (int k = 0; k < supernode.below(); ++k) x.row(supernode.rows_below()[k]) -= below.row(k);
  }

  // The same of x <- L^-T x; supernodes descend.
  template <typename Columns>
  void Backward(int s, Columns& x, Columns& below) const {
    const Supernode supernode = SliceOf(shape_, s);
    const Eigen::Map<const Eigen::MatrixXd> L = ValuesOf(supernode);
    auto x_J = x.middleRows(supernode.first_col, supernode.col_count);
    if (supernode.below() > 0) {
      below.resize(supernode.below(), x.cols());
      for (int k = 0; k < supernode.below(); ++k) below.row(k) = x.row(supernode.rows_below()[k]);
      x_J.noalias() -= L.bottomRows(supernode.below()).transpose() * below;
    }
    L.topRows(supernode.col_count).transpose().template triangularView<Eigen::Upper>().solveInPlace(x_J);
  }

 private:
  // Where a block lies in the factor, or its transpose, if the factor's order swaps its row and column.
  struct Location {
    std::size_t start = 0;
    int stride = 0;
    bool transposed = false;
  };

  Location Locate(int block_row, int block_col) const {
    int row = shape_.position[B * static_cast<std::size_t>(block_row)];
    int col = shape_.position[B * static_cast<std::size_t>(block_col)];
    const bool transposed = row < col;
    if (transposed) std::swap(row, col);
    const Supernode at = SliceOf(shape_, shape_.supernode_of_col[static_cast<std::size_t>(col)]);
    const auto k = static_cast<std::size_t>(std::lower_bound(at.rows, at.rows + at.row_count, row) - at.rows);
    return {at.start + k + static_cast<std::size_t>(col - at.first_col) * static_cast<std::size_t>(at.row_count),
            at.row_count, transposed};
  }

  void Write(const Location& at, const Block& block, double diagonal_factor) {
    Eigen::Map<Block, 0, Eigen::OuterStride<>> target(values_.data() + at.start, Eigen::OuterStride<>(at.stride));
    if (at.transposed)
      target = block.transpose();
    else
      target = block;
    target.diagonal() *= diagonal_factor;
  }

  Eigen::Map<Eigen::MatrixXd> ValuesOf(const Supernode& supernode) {
    return {values_.data() + supernode.start, supernode.row_count, supernode.col_count};
  }

  Eigen::Map<const Eigen::MatrixXd> ValuesOf(const Supernode& supernode) const {
    return {values_.data() + supernode.start, supernode.row_count, supernode.col_count};
  }

  bool Eliminate(const Supernode& supernode) {
    Eigen::Map<Eigen::MatrixXd> L = ValuesOf(supernode);
    auto L_JJ = L.topRows(supernode.col_count);
    Eigen::Ref<Eigen::MatrixXd> in_place(L_JJ);
    if (Eigen::LLT<Eigen::Ref<Eigen::MatrixXd>>(in_place).info() != Eigen::Success) return false;
    const int below = supernode.below();
    if (below == 0) return true;
    auto L_RJ = L.bottomRows(below);
    L_JJ.transpose().template triangularView<Eigen::Upper>().template solveInPlace<Eigen::OnTheRight>(L_RJ);
    Eigen::Map<Eigen::MatrixXd> update(update_.data(), below, below);
    update.template triangularView<Eigen::Lower>().setZero();
    update.template selfadjointView<Eigen::Lower>().rankUpdate(L_RJ);
    SubtractFromAncestors(supernode, update);
    return true;
  }

  void SubtractFromAncestors(const Supernode& supernode, const Eigen::Map<Eigen::MatrixXd>& update) {
    const int* rows = supernode.rows_below();
    const int below = supernode.below();
    for (int first = 0, last = 0; first < below; first = last) {
      const int s = shape_.supernode_of_col[static_cast<std::size_t>(rows[first])];
      while (last < below && shape_.supernode_of_col[static_cast<std::size_t>(rows[last])] == s) ++last;
      const Supernode ancestor = SliceOf(shape_, s);
      for (int k = 0, at = 0; k < below - first; ++k) {
        while (ancestor.rows[at] != rows[first + k]) ++at;
        place_[static_cast<std::size_t>(k)] = at;
      }
      for (int c = first; c < last; ++c) {
        double* column =
            values_.data() + ancestor.start +
            static_cast<std::size_t>(rows[c] - ancestor.first_col) * static_cast<std::size_t>(ancestor.row_count);
        for (int r = c; r < below; ++r) column[place_[static_cast<std::size_t>(r - first)]] -= update(r, c);
      }
    }
  }

  BlockPattern pattern_;
  Supernodes shape_;
  std::vector<Location> diagonal_at_, off_diagonal_at_;
  std::vector<double> values_, update_;
  std::vector<int> place_;
  Eigen::MatrixXd work_, below_;
};

}  // namespace rigcal::graph
