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

  // All blocks of the pattern, zero.
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

constexpr int kBlocksDenseMax = 40;
constexpr std::size_t kFactorBytesMax = std::size_t{2} << 30;
// Null if the factor would need more than kFactorBytesMax. `blocks_dense_max`: up to this many blocks it is dense.
template <int B>
[[nodiscard]] std::unique_ptr<BlockCholesky<B>> MakeCholesky(const BlockPattern& pattern,
                                                             int blocks_dense_max = kBlocksDenseMax);

// What is known of a Cholesky factor before its numbers (by CHOLMOD): a fill-reducing order, and the shape of a
// supernodal factor: which columns are kept together in one dense trapezoid, and their rows.

// What a factor of blocks of one row would take: its entries, and floating-point operations.
struct EliminationCost {
  double entries = 0.0, flops = 0.0;
};

// A fill-reducing order of the vertices of a graph: position p is taken by vertex order[p]. Natural for small graphs,
// which have no estimate of the cost either.
struct Elimination {
  std::vector<int> order;
  EliminationCost cost;
};
// Links may come twice, in any order.
[[nodiscard]] Elimination EliminationOrder(const BlockPattern& links);
// The same with some vertices after all others.
[[nodiscard]] std::vector<int> ConstrainedOrder(const BlockPattern& links, const std::vector<bool>& is_last);

// Supernode s has the columns first_col[s] .. first_col[s+1]-1 and the rows rows[row_start[s] .. row_start[s+1]-1],
// which begin with its own columns and ascend. Its values are column-major, as many rows as it has, from
// value_start[s].
struct Supernodes {
  int size = 0;
  std::vector<int> first_col, row_start, rows;
  std::vector<std::size_t> value_start;  // one more than supernodes: the last is the number of values
  std::vector<int> supernode_of_col;
  std::vector<int> position;  // where a row or column of the matrix comes in the factor

  // How many supernodes.
  [[nodiscard]] int count() const { return static_cast<int>(first_col.size()) - 1; }
};

// One supernode's slice.
struct Supernode {
  int first_col = 0, col_count = 0, row_count = 0;
  const int* rows = nullptr;
  std::size_t start = 0;

  // Of its rows, how many lie below its own triangle, and which: in the order of the factor.
  [[nodiscard]] int below() const { return row_count - col_count; }
  [[nodiscard]] const int* rows_below() const { return rows + col_count; }
};
// `s` from 0 to count() - 1; valid as long as `supernodes` is.
[[nodiscard]] Supernode SliceOf(const Supernodes& supernodes, int s);

// Symbolic analysis by CHOLMOD on the pattern of blocks, then every block spread to block_size rows and columns.
// Empty (size 0) if the factor would need more than kFactorBytesMax.
[[nodiscard]] Supernodes AnalyzeSupernodes(const BlockPattern& pattern, int block_size);

}  // namespace rigcal::graph
