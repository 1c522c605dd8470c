// Conjugate gradients under the inverse of the diagonal blocks, in the place of a Cholesky factor: solutions are right
// to kResidualRatio of the right-hand side, which is enough for the steps of a descent. Where they do not get there,
// and for inverses, a factor is made after all. And the choice between the two.
#pragma once

#include <memory>
#include <vector>

#include "server/graph/solve/problem.h"

namespace rigcal::graph {

class ConjugateGradients final : public BlockCholesky<6> {
 public:
  // Reads `pattern` as long as it lives; blocks off the diagonal may be added between calls.
  explicit ConjugateGradients(const BlockPattern& pattern) : pattern_(pattern) {}

  // False if a diagonal block is not positive definite. Reads `matrix` until the next call.
  bool Factor(const BlockMatrix<6>& matrix, double lambda) override;
  // NaN where neither way finds a solution.
  void SolveInPlace(Eigen::Ref<Eigen::MatrixXd> rhs) override;
  // Empty if the factor is too large or does not exist.
  std::vector<Block> InverseDiagonal() override;
  // Products of blocks in all calls, as far as no factor was made.
  [[nodiscard]] double products() const { return products_; }

 private:
  using Map = Eigen::Map<Eigen::VectorXd>;
  bool Iterate(const Eigen::VectorXd& rhs, Eigen::VectorXd& x);
  bool FactorExactly();
  void Multiply(const Eigen::VectorXd& x, Eigen::VectorXd& product) const;
  void Precondition(const Eigen::VectorXd& residual, Eigen::VectorXd& z) const;

  const BlockPattern& pattern_;
  const BlockMatrix<6>* matrix_ = nullptr;
  double lambda_ = 0.0;
  std::vector<Block> diagonal_;  // inverses of the damped diagonal blocks
  std::unique_ptr<BlockCholesky<6>> exact_;
  bool stalled_ = false;  // on the matrix at hand: exact_ is its factor
  Eigen::VectorXd r_, z_, p_, Hp_;
  double products_ = 0.0;
};

// True where every vertex is a few edges from the reference (then conjugate gradients need few iterations) and a factor
// would cost far more than they do. A matter of structure alone: numbers do not enter.
[[nodiscard]] bool PrefersConjugateGradients(const Problem& problem);

// Null if a factor is needed and would be too large. What it gives for Factor() reads that matrix until the next
// Factor(): it must stay as it is in between.
[[nodiscard]] std::unique_ptr<BlockCholesky<6>> MakeStepSolver(const Problem& problem);

}  // namespace rigcal::graph
