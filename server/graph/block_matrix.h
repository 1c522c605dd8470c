// Symmetric block-sparse matrices with square blocks of fixed size, in elimination order, and their Cholesky factors.
#pragma once

#include <Eigen/Core>
#include <memory>
#include <tuple>
#include <vector>

namespace rigcal::graph {

struct BlockPosition {
  int row = 0, col = 0;  // row > col
  friend bool operator==(const BlockPosition&, const BlockPosition&) = default;
  friend auto operator<=>(const BlockPosition& a, const BlockPosition& b) {
    return std::tie(a.col, a.row) <=> std::tie(b.col, b.row);
  }
};

struct BlockPattern {
  int block_count = 0;
  std::vector<BlockPosition> off_diagonal;  // lower triangle, unique, sorted
};

// The lower triangle: diagonal blocks whole, off-diagonal blocks in the order of the pattern.
template <int B>
struct BlockMatrix {
  using Block = Eigen::Matrix<double, B, B>;
  std::vector<Block> diagonal, off_diagonal;

  void SetZero(const BlockPattern& pattern) {
    diagonal.assign(static_cast<std::size_t>(pattern.block_count), Block::Zero());
    off_diagonal.assign(pattern.off_diagonal.size(), Block::Zero());
  }
};

// Cholesky factor with the pattern analysed once: dense for small matrices, supernodal (CHOLMOD) for large ones.
// Factor and Solve allocate nothing after the first call.
template <int B>
class BlockCholesky {
 public:
  using Block = Eigen::Matrix<double, B, B>;
  virtual ~BlockCholesky() = default;
  // Factors matrix + lambda * diag(matrix); false if that is not positive definite (then Solve must not be called).
  [[nodiscard]] virtual bool Factor(const BlockMatrix<B>& matrix, double lambda) = 0;
  // matrix^-1 rhs, in place; rhs has B * block_count rows.
  virtual void SolveInPlace(Eigen::Ref<Eigen::MatrixXd> rhs) = 0;
  // The diagonal blocks of the inverse.
  [[nodiscard]] virtual std::vector<Block> InverseDiagonal() = 0;
};

// Null if the factor would need more than kFactorBytesMax. `blocks_dense_max`: up to this many blocks it is dense.
constexpr int kBlocksDenseMax = 40;
constexpr std::size_t kFactorBytesMax = std::size_t{2} << 30;
template <int B>
[[nodiscard]] std::unique_ptr<BlockCholesky<B>> MakeCholesky(const BlockPattern& pattern,
                                                             int blocks_dense_max = kBlocksDenseMax);

}  // namespace rigcal::graph
