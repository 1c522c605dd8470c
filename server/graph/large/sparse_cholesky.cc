#include <Eigen/Cholesky>
#include <algorithm>
#include <utility>
#include <vector>

#include "server/graph/large/block_matrix.h"
#include "server/graph/large/dense_cholesky.h"

namespace rigcal::graph {
namespace {

Supernode SupernodeOf(const Supernodes& supernodes, int col) {
  return SliceOf(supernodes, supernodes.supernode_of_col[static_cast<std::size_t>(col)]);
}

// Where a column of the supernode has an entry, row >= col, among all values.
std::size_t PlaceOf(const Supernode& supernode, int row, int col) {
  const int* found = std::lower_bound(supernode.rows, supernode.rows + supernode.row_count, row);
  return supernode.start + static_cast<std::size_t>(found - supernode.rows) +
         static_cast<std::size_t>(col - supernode.first_col) * static_cast<std::size_t>(supernode.row_count);
}

// The entries of (L L^T)^-1 on the pattern of L (Takahashi's recursion, supernode by supernode, last to first), exact
// up to rounding, without the inverse itself.
class SelectedInverse {
 public:
  // `values` of L in the layout of `supernodes`; both are used by the constructor only, the shape by At() too.
  SelectedInverse(const Supernodes& supernodes, const std::vector<double>& values);
  // Entry (row, col) of the inverse, in positions of the factor; it must lie in the pattern of L (any entry of A does).
  [[nodiscard]] double At(int row, int col) const;

 private:
  void InvertSupernode(int s, const std::vector<double>& L_values);
  void GatherAncestors(const Supernode& supernode, Eigen::MatrixXd& Z_below);
  void GatherFrom(const Supernode& ancestor, const int* cols, int col_count, int first, Eigen::MatrixXd& Z_below) const;

  const Supernodes& shape_;
  std::vector<int> place_;      // of a row among the rows below the supernode at hand; -1: not there
  std::vector<double> values_;  // of the inverse, in the layout of L
};

SelectedInverse::SelectedInverse(const Supernodes& supernodes, const std::vector<double>& values)
    : shape_(supernodes), place_(static_cast<std::size_t>(supernodes.size), -1), values_(values.size()) {
  for (int s = supernodes.count() - 1; s >= 0; --s) InvertSupernode(s, values);
}

// Z_RJ = -Z_RR Y and Z_JJ = L_JJ^-T L_JJ^-1 - Y^T Z_RJ with Y = L_RJ L_JJ^-1, R the rows below the supernode J.
void SelectedInverse::InvertSupernode(int s, const std::vector<double>& L_values) {
  const Supernode shape = SliceOf(shape_, s);
  const int below = shape.below();
  const Eigen::Map<const Eigen::MatrixXd> L(L_values.data() + shape.start, shape.row_count, shape.col_count);
  Eigen::Map<Eigen::MatrixXd> Z(values_.data() + shape.start, shape.row_count, shape.col_count);
  const auto L_JJ = L.topRows(shape.col_count).triangularView<Eigen::Lower>();
  Eigen::MatrixXd L_inverse = Eigen::MatrixXd::Identity(shape.col_count, shape.col_count);
  L_JJ.solveInPlace(L_inverse);
  Eigen::MatrixXd Z_JJ = L_inverse.transpose() * L_inverse;
  if (below > 0) {
    Eigen::MatrixXd Z_RR(below, below);
    GatherAncestors(shape, Z_RR);
    const Eigen::MatrixXd Y = L.bottomRows(below) * L_inverse;
    Z.bottomRows(below).noalias() = -(Z_RR.selfadjointView<Eigen::Lower>() * Y);
    Z_JJ.noalias() -= Y.transpose() * Z.bottomRows(below);
  }
  Z.topRows(shape.col_count) = 0.5 * (Z_JJ + Z_JJ.transpose());
}

// The rows below a supernode are a clique of the filled graph: all their entries were computed before.
void SelectedInverse::GatherAncestors(const Supernode& supernode, Eigen::MatrixXd& Z_below) {
  const int* rows = supernode.rows_below();
  const int below = supernode.below();
  for (int k = 0; k < below; ++k) place_[static_cast<std::size_t>(rows[k])] = k;
  for (int first = 0, last = 0; first < below; first = last) {
    const int ancestor = shape_.supernode_of_col[static_cast<std::size_t>(rows[first])];
    while (last < below && shape_.supernode_of_col[static_cast<std::size_t>(rows[last])] == ancestor) ++last;
    GatherFrom(SliceOf(shape_, ancestor), rows + first, last - first, first, Z_below);
  }
  for (int k = 0; k < below; ++k) place_[static_cast<std::size_t>(rows[k])] = -1;
}

void SelectedInverse::GatherFrom(const Supernode& ancestor, const int* cols, int col_count, int first,
                                 Eigen::MatrixXd& Z_below) const {
  for (int k = 0; k < ancestor.row_count; ++k) {
    const int row = place_[static_cast<std::size_t>(ancestor.rows[k])];
    if (row < 0) continue;
    const double* source = values_.data() + ancestor.start + k;
    for (int c = 0; c < col_count; ++c) {
      const int column = cols[c] - ancestor.first_col;
      if (row >= first + c) Z_below(row, first + c) = source[static_cast<std::ptrdiff_t>(column) * ancestor.row_count];
    }
  }
}

double SelectedInverse::At(int row, int col) const {
  return values_[PlaceOf(SupernodeOf(shape_, std::min(row, col)), std::max(row, col), std::min(row, col))];
}

// Supernodal Cholesky, right-looking: the shape comes from CHOLMOD, the numbers from Eigen's dense kernels on one
// thread. (CHOLMOD's own numeric phase starts OpenMP threads that spin, and its BLAS is chosen by the machine: neither
// is acceptable where the same edges must give the same bytes and many robots are solved side by side.)
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

 private:
  // Where a block lies in the factor, or its transpose, if the factor's order swaps its row and column.
  struct Location {
    std::size_t start = 0;
    int stride = 0;
    bool transposed = false;
  };

  // One supernode's part of x <- L^-1 x, for x in the factor's order; supernodes ascend. `below` is scratch.
  void Forward(int s, Eigen::MatrixXd& x, Eigen::MatrixXd& below) const {
    const Supernode supernode = SliceOf(shape_, s);
    const Eigen::Map<const Eigen::MatrixXd> L = ValuesOf(supernode);
    auto x_J = x.middleRows(supernode.first_col, supernode.col_count);
    L.topRows(supernode.col_count).template triangularView<Eigen::Lower>().solveInPlace(x_J);
    if (supernode.below() == 0) return;
    below.noalias() = L.bottomRows(supernode.below()) * x_J;
    for (int k = 0; k < supernode.below(); ++k) x.row(supernode.rows_below()[k]) -= below.row(k);
  }

  // The same of x <- L^-T x; supernodes descend.
  void Backward(int s, Eigen::MatrixXd& x, Eigen::MatrixXd& below) const {
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

  Location Locate(int block_row, int block_col) const {
    int row = shape_.position[B * static_cast<std::size_t>(block_row)];
    int col = shape_.position[B * static_cast<std::size_t>(block_col)];
    const bool transposed = row < col;
    if (transposed) std::swap(row, col);
    const Supernode at = SupernodeOf(shape_, col);
    return {PlaceOf(at, row, col), at.row_count, transposed};
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

}  // namespace

template <int B>
std::unique_ptr<BlockCholesky<B>> MakeCholesky(const BlockPattern& pattern, int blocks_dense_max) {
  if (pattern.block_count <= blocks_dense_max) return std::make_unique<DenseCholesky<B>>(pattern);
  Supernodes shape = AnalyzeSupernodes(pattern, B);
  if (shape.size == 0) return nullptr;
  return std::make_unique<SparseCholesky<B>>(pattern, std::move(shape));
}

template std::unique_ptr<BlockCholesky<1>> MakeCholesky<1>(const BlockPattern&, int);
template std::unique_ptr<BlockCholesky<3>> MakeCholesky<3>(const BlockPattern&, int);
template std::unique_ptr<BlockCholesky<6>> MakeCholesky<6>(const BlockPattern&, int);

}  // namespace rigcal::graph
