// Supernodal Cholesky through CHOLMOD, whose dense kernels are those of the BLAS of the machine.
#include <cholmod.h>

#include <algorithm>
#include <cstring>

#include "server/graph/cholesky_kinds.h"
#include "server/graph/selected_inverse.h"

namespace rigcal::graph {
namespace {

// Owns CHOLMOD's workspace; not shared between threads.
class Common {
 public:
  Common() {
    cholmod_start(&common_);
    common_.print = 0;
    common_.supernodal = CHOLMOD_SUPERNODAL;
    common_.nmethods = 1;  // the blocks come in elimination order
    common_.method[0].ordering = CHOLMOD_NATURAL;
    common_.postorder = 1;
  }
  ~Common() { cholmod_finish(&common_); }
  Common(const Common&) = delete;
  Common& operator=(const Common&) = delete;
  cholmod_common* get() { return &common_; }

 private:
  cholmod_common common_{};
};

template <int B>
class SparseCholesky final : public BlockCholesky<B> {
 public:
  using typename BlockCholesky<B>::Block;

  explicit SparseCholesky(const BlockPattern& pattern) : pattern_(pattern) {
    AllocateMatrix();
    factor_ = cholmod_analyze(matrix_, common_.get());
  }
  ~SparseCholesky() override {
    cholmod_free_dense(&x_, common_.get());
    cholmod_free_dense(&y_, common_.get());
    cholmod_free_dense(&e_, common_.get());
    cholmod_free_factor(&factor_, common_.get());
    cholmod_free_sparse(&matrix_, common_.get());
  }
  SparseCholesky(const SparseCholesky&) = delete;
  SparseCholesky& operator=(const SparseCholesky&) = delete;

  bool Factor(const BlockMatrix<B>& matrix, double lambda) override {
    if (matrix_ == nullptr || factor_ == nullptr) return false;
    for (int v = 0; v < pattern_.block_count; ++v) WriteDiagonal(v, matrix.diagonal[static_cast<std::size_t>(v)], lambda);
    for (std::size_t s = 0; s < pattern_.off_diagonal.size(); ++s) WriteOffDiagonal(s, matrix.off_diagonal[s]);
    return cholmod_factorize(matrix_, factor_, common_.get()) != 0 && common_.get()->status == CHOLMOD_OK &&
           factor_->minor == factor_->n;
  }

  void SolveInPlace(Eigen::Ref<Eigen::MatrixXd> rhs) override {
    cholmod_dense b{};
    b.nrow = static_cast<std::size_t>(rhs.rows());
    b.ncol = static_cast<std::size_t>(rhs.cols());
    b.d = static_cast<std::size_t>(rhs.outerStride());
    b.nzmax = b.d * b.ncol;
    b.x = rhs.data();
    b.xtype = CHOLMOD_REAL;
    b.dtype = CHOLMOD_DOUBLE;
    cholmod_solve2(CHOLMOD_A, factor_, &b, nullptr, &x_, nullptr, &y_, &e_, common_.get());
    rhs = Eigen::Map<const Eigen::MatrixXd>(static_cast<const double*>(x_->x), rhs.rows(), rhs.cols());
  }

  std::vector<Block> InverseDiagonal() override {
    const SelectedInverse inverse(View());
    std::vector<int> position(factor_->n);
    for (std::size_t k = 0; k < factor_->n; ++k)
      position[static_cast<std::size_t>(static_cast<const int*>(factor_->Perm)[k])] = static_cast<int>(k);
    std::vector<Block> blocks(static_cast<std::size_t>(pattern_.block_count));
    for (std::size_t v = 0; v < blocks.size(); ++v) {
      const int* at = position.data() + B * v;
      for (int r = 0; r < B; ++r)
        for (int c = 0; c < B; ++c) blocks[v](r, c) = inverse.At(at[r], at[c]);
    }
    return blocks;
  }

 private:
  // Lower triangle by columns. Column k of block column v holds entries k..B-1 of the diagonal block, then the blocks below.
  void AllocateMatrix() {
    const auto n = static_cast<std::size_t>(B * pattern_.block_count);
    const std::size_t entries = static_cast<std::size_t>(pattern_.block_count) * (B * (B + 1) / 2) +
                                pattern_.off_diagonal.size() * (B * B);
    matrix_ = cholmod_allocate_sparse(n, n, entries, 1, 1, -1, CHOLMOD_REAL, common_.get());
    if (matrix_ == nullptr) return;
    std::size_t slot = 0;
    place_in_column_.resize(pattern_.off_diagonal.size());
    for (int v = 0; v < pattern_.block_count; ++v) {
      const std::size_t slot_begin = slot;
      while (slot < pattern_.off_diagonal.size() && pattern_.off_diagonal[slot].col == v) {
        place_in_column_[slot] = static_cast<int>(slot - slot_begin);
        ++slot;
      }
      FillBlockColumn(v, slot_begin, slot);
    }
  }

  void FillBlockColumn(int v, std::size_t slot_begin, std::size_t slot_end) {
    int* starts = Starts();
    auto* rows = static_cast<int*>(matrix_->i);
    for (int k = 0; k < B; ++k) {
      int entry = starts[B * v + k];
      for (int r = k; r < B; ++r) rows[entry++] = B * v + r;
      for (std::size_t s = slot_begin; s < slot_end; ++s)
        for (int r = 0; r < B; ++r) rows[entry++] = B * pattern_.off_diagonal[s].row + r;
      starts[B * v + k + 1] = entry;
    }
  }

  void WriteDiagonal(int v, const Block& block, double lambda) {
    for (int k = 0; k < B; ++k) {
      double* column = Values() + Starts()[B * v + k];
      std::memcpy(column, block.data() + B * k + k, sizeof(double) * static_cast<std::size_t>(B - k));
      column[0] *= 1.0 + lambda;
    }
  }

  void WriteOffDiagonal(std::size_t slot, const Block& block) {
    const int v = pattern_.off_diagonal[slot].col;
    for (int k = 0; k < B; ++k) {
      double* column = Values() + Starts()[B * v + k] + (B - k) + B * place_in_column_[slot];
      std::memcpy(column, block.data() + B * k, sizeof(double) * B);
    }
  }

  [[nodiscard]] SupernodalView View() const {
    SupernodalView view;
    view.size = static_cast<int>(factor_->n);
    view.supernode_count = static_cast<int>(factor_->nsuper);
    view.super = static_cast<const int*>(factor_->super);
    view.row_start = static_cast<const int*>(factor_->pi);
    view.value_start = static_cast<const int*>(factor_->px);
    view.rows = static_cast<const int*>(factor_->s);
    view.values = static_cast<const double*>(factor_->x);
    view.value_count = factor_->xsize;
    return view;
  }

  [[nodiscard]] int* Starts() const { return static_cast<int*>(matrix_->p); }
  [[nodiscard]] double* Values() const { return static_cast<double*>(matrix_->x); }

  Common common_;
  BlockPattern pattern_;
  std::vector<int> place_in_column_;
  cholmod_sparse* matrix_ = nullptr;
  cholmod_factor* factor_ = nullptr;
  cholmod_dense *x_ = nullptr, *y_ = nullptr, *e_ = nullptr;
};

}  // namespace

template <int B>
std::unique_ptr<BlockCholesky<B>> MakeSparseCholesky(const BlockPattern& pattern) {
  return std::make_unique<SparseCholesky<B>>(pattern);
}

template std::unique_ptr<BlockCholesky<1>> MakeSparseCholesky<1>(const BlockPattern&);
template std::unique_ptr<BlockCholesky<3>> MakeSparseCholesky<3>(const BlockPattern&);
template std::unique_ptr<BlockCholesky<6>> MakeSparseCholesky<6>(const BlockPattern&);

}  // namespace rigcal::graph
