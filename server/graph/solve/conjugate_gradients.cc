#include "server/graph/solve/conjugate_gradients.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace rigcal::graph {
namespace {

constexpr double kResidualRatio = 1e-2;
constexpr int kIterationsMax = 100;

// One multiplication with the matrix and one with the inverses of its diagonal; six vectors are a block.
double ProductsOfRound(const BlockPattern& pattern) {
  return (2.0 * pattern.block_count + 2.0 * static_cast<double>(pattern.off_diagonal.size())) / 6.0;
}

// Column by column, so that a column stays in registers.
//
// The lower triangle of C becomes its Cholesky factor with the *inverses* of the pivots on the diagonal; false if C is
// not positive definite. What is above the diagonal means nothing.
bool FactorBlock(Matrix6d& C) {
  for (int c = 0; c < 6; ++c) {
    Vector6d column = C.col(c);
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
void DivideByTransposed(const Matrix6d& L, Matrix6d& C) {
  for (int c = 0; c < 6; ++c) {
    Vector6d column = C.col(c);
    for (int k = 0; k < c; ++k) column -= C.col(k) * L(c, k);
    C.col(c) = column * L(c, c);
  }
}

// C <- C^-1; false if C is not positive definite.
bool InvertBlock(Matrix6d& C) {
  if (!FactorBlock(C)) return false;
  Matrix6d rows = Matrix6d::Identity();  // L^-T
  DivideByTransposed(C, rows);
  C.noalias() = rows * rows.transpose();
  return true;
}

constexpr int kLevelsMax = 12;
constexpr double kProductsPerLevel = 20.0;  // of H with a vector, in a whole descent, by experience

// Levels of a breadth-first search from the reference; kLevelsMax + 1 if there are more.
int CountLevels(const Problem& problem) {
  std::vector<int> level(static_cast<std::size_t>(problem.vertex_count), kLevelsMax + 1);
  level[0] = 0;
  for (int at = 1; at <= kLevelsMax; ++at) {
    bool reached = false;
    const auto reach = [&level, &reached, at](int from, int to) {
      int& other = level[static_cast<std::size_t>(to)];
      if (level[static_cast<std::size_t>(from)] != at - 1 || other <= at) return;
      other = at;
      reached = true;
    };
    for (const Constraint& c : problem.constraints) reach(c.i, c.j), reach(c.j, c.i);
    if (!reached) break;
  }
  return *std::max_element(level.begin(), level.end());
}

}  // namespace

bool ConjugateGradients::Factor(const BlockMatrix<6>& matrix, double lambda) {
  matrix_ = &matrix;
  lambda_ = lambda;
  stalled_ = false;
  diagonal_ = matrix.diagonal;
  for (Block& block : diagonal_) {
    block.diagonal() *= 1.0 + lambda;
    if (!InvertBlock(block)) return false;
  }
  return true;
}

void ConjugateGradients::SolveInPlace(Eigen::Ref<Eigen::MatrixXd> rhs) {
  Eigen::VectorXd x;
  for (Eigen::Index column = 0; column < rhs.cols() && !stalled_; ++column) {
    if (Iterate(rhs.col(column), x)) {
      rhs.col(column) = x;
    } else {
      stalled_ = true;
      if (!FactorExactly()) return rhs.setConstant(std::numeric_limits<double>::quiet_NaN()), void();
      return exact_->SolveInPlace(rhs.rightCols(rhs.cols() - column));
    }
  }
  if (stalled_ && exact_ != nullptr) exact_->SolveInPlace(rhs);
}

std::vector<ConjugateGradients::Block> ConjugateGradients::InverseDiagonal() {
  if (!stalled_ && !FactorExactly()) return {};
  return exact_->InverseDiagonal();
}

bool ConjugateGradients::FactorExactly() {
  if (!std::is_sorted(pattern_.off_diagonal.begin(), pattern_.off_diagonal.end())) return false;
  if (exact_ == nullptr) exact_ = MakeCholesky<6>(pattern_, 0);
  return exact_ != nullptr && exact_->Factor(*matrix_, lambda_);
}

bool ConjugateGradients::Iterate(const Eigen::VectorXd& rhs, Eigen::VectorXd& x) {
  x.setZero(rhs.size());
  r_ = rhs;
  Precondition(r_, z_);
  p_ = z_;
  double rz = r_.dot(z_);
  const double enough = kResidualRatio * kResidualRatio * rz;
  for (int iteration = 0; iteration < kIterationsMax; ++iteration) {
    if (rz <= enough) return true;
    Multiply(p_, Hp_);
    products_ += ProductsOfRound(pattern_);
    const double curvature = p_.dot(Hp_);
    if (!(curvature > 0.0)) return false;
    const double length = rz / curvature;
    x += length * p_;
    r_ -= length * Hp_;
    Precondition(r_, z_);
    const double rz_before = std::exchange(rz, r_.dot(z_));
    p_ = z_ + (rz / rz_before) * p_;
  }
  return false;
}

void ConjugateGradients::Multiply(const Eigen::VectorXd& x, Eigen::VectorXd& product) const {
  product.resize(x.size());
  for (std::size_t v = 0; v < diagonal_.size(); ++v) {
    const Eigen::Index row = 6 * static_cast<Eigen::Index>(v);
    const Vector6d x_v = x.segment<6>(row);
    Vector6d y = matrix_->diagonal[v] * x_v;
    if (lambda_ > 0.0) y += lambda_ * matrix_->diagonal[v].diagonal().cwiseProduct(x_v);
    product.segment<6>(row) = y;
  }
  for (std::size_t s = 0; s < pattern_.off_diagonal.size(); ++s) {
    const Block& block = matrix_->off_diagonal[s];
    const Eigen::Index row = 6 * pattern_.off_diagonal[s].row, col = 6 * pattern_.off_diagonal[s].col;
    const Vector6d x_row = x.segment<6>(row), x_col = x.segment<6>(col);
    product.segment<6>(row) += block * x_col;
    product.segment<6>(col) += block.transpose() * x_row;
  }
}

void ConjugateGradients::Precondition(const Eigen::VectorXd& residual, Eigen::VectorXd& z) const {
  z.resize(residual.size());
  for (std::size_t v = 0; v < diagonal_.size(); ++v) {
    const Eigen::Index row = 6 * static_cast<Eigen::Index>(v);
    const Vector6d part = residual.segment<6>(row);
    z.segment<6>(row).noalias() = diagonal_[v] * part;
  }
}

bool PrefersConjugateGradients(const Problem& problem) {
  if (problem.free_count() <= kBlocksDenseMax) return false;
  const EliminationCost& cost = problem.elimination_cost;
  if (cost.entries * 36.0 * sizeof(double) > static_cast<double>(kFactorBytesMax)) return false;
  const double product =
      static_cast<double>(problem.free_count()) + 2.0 * static_cast<double>(problem.pattern.off_diagonal.size());
  if (216.0 * cost.flops <= kProductsPerLevel * 72.0 * product) return false;
  const int levels = CountLevels(problem);
  return levels <= kLevelsMax && 216.0 * cost.flops > kProductsPerLevel * levels * 72.0 * product &&
         problem.HasFullRank();
}

std::unique_ptr<BlockCholesky<6>> MakeStepSolver(const Problem& problem) {
  if (PrefersConjugateGradients(problem)) return std::make_unique<ConjugateGradients>(problem.pattern);
  return MakeCholesky<6>(problem.pattern);
}

}  // namespace rigcal::graph
