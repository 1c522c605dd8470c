#include <Eigen/Cholesky>

#include "server/graph/cholesky_kinds.h"

namespace rigcal::graph {
namespace {

template <int B>
class DenseCholesky final : public BlockCholesky<B> {
 public:
  using typename BlockCholesky<B>::Block;

  explicit DenseCholesky(const BlockPattern& pattern)
      : off_diagonal_(pattern.off_diagonal), L_(B * pattern.block_count, B * pattern.block_count) {}

  bool Factor(const BlockMatrix<B>& matrix, double lambda) override {
    L_.setZero();
    for (std::size_t v = 0; v < matrix.diagonal.size(); ++v)
      L_.template block<B, B>(B * static_cast<int>(v), B * static_cast<int>(v)) = matrix.diagonal[v];
    for (std::size_t s = 0; s < off_diagonal_.size(); ++s)
      L_.template block<B, B>(B * off_diagonal_[s].row, B * off_diagonal_[s].col) = matrix.off_diagonal[s];
    if (lambda > 0.0) L_.diagonal() *= 1.0 + lambda;
    Eigen::Ref<Eigen::MatrixXd> in_place(L_);
    return Eigen::LLT<Eigen::Ref<Eigen::MatrixXd>>(in_place).info() == Eigen::Success;
  }

  void SolveInPlace(Eigen::Ref<Eigen::MatrixXd> rhs) override {
    L_.template triangularView<Eigen::Lower>().solveInPlace(rhs);
    L_.transpose().template triangularView<Eigen::Upper>().solveInPlace(rhs);
  }

  std::vector<Block> InverseDiagonal() override {
    const int size = static_cast<int>(L_.rows());
    Eigen::MatrixXd L_inverse = Eigen::MatrixXd::Identity(size, size);
    L_.template triangularView<Eigen::Lower>().solveInPlace(L_inverse);
    std::vector<Block> blocks;
    blocks.reserve(static_cast<std::size_t>(size / B));
    for (int start = 0; start < size; start += B) {
      const auto columns = L_inverse.block(start, start, size - start, B);
      blocks.push_back(columns.transpose() * columns);
    }
    return blocks;
  }

 private:
  std::vector<BlockPosition> off_diagonal_;
  Eigen::MatrixXd L_;
};

}  // namespace

template <int B>
std::unique_ptr<BlockCholesky<B>> MakeDenseCholesky(const BlockPattern& pattern) {
  return std::make_unique<DenseCholesky<B>>(pattern);
}

template <int B>
std::unique_ptr<BlockCholesky<B>> MakeCholesky(const BlockPattern& pattern, int blocks_dense_max) {
  if (pattern.block_count <= blocks_dense_max) return MakeDenseCholesky<B>(pattern);
  return MakeSparseCholesky<B>(pattern);
}

template std::unique_ptr<BlockCholesky<1>> MakeCholesky<1>(const BlockPattern&, int);
template std::unique_ptr<BlockCholesky<3>> MakeCholesky<3>(const BlockPattern&, int);
template std::unique_ptr<BlockCholesky<6>> MakeCholesky<6>(const BlockPattern&, int);

}  // namespace rigcal::graph
