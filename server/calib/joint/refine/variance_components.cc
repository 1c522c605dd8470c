#include "server/calib/joint/refine/variance_components.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

#include "server/base/process/parallel_for.h"

namespace rigcal::calib::joint {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr int kSweeps = 50, kVarianceRoundsMax = 15;
constexpr double kUnseen = 0.01;           // information times variance: such a direction tells nothing of the variance
constexpr double kVarianceSettled = 0.05;  // of a variance's own sigma
constexpr double kStepMax = 5.0;           // ratio of a variance, from iteration to iteration

auto BlockOf(const MatrixXd& S, const std::vector<int>& at, std::size_t row, std::size_t column) {
  return S.block(at[row], at[column], at[row + 1] - at[row], at[column + 1] - at[column]);
}

// Where the moments point: E |score_k|^2 = tr S_kk + sum_l variance_l |S_kl|^2, by Gauss-Seidel with none below its
// share of what chance makes of it, sqrt(2) / |S_kk|.
std::vector<double> VarianceByMoments(const RandomEffects& effects) {
  const std::size_t blocks = effects.blocks();
  const auto count = static_cast<Eigen::Index>(blocks);
  MatrixXd N(count, count);
  ParallelFor(blocks, [&](std::size_t k) {
    for (std::size_t l = 0; l < blocks; ++l)
      N(static_cast<Eigen::Index>(k), static_cast<Eigen::Index>(l)) =
          BlockOf(effects.S, effects.at, k, l).squaredNorm();
  });
  VectorXd excess(count), variance = VectorXd::Zero(count), least(count);
  for (Eigen::Index k = 0; k < count; ++k) {
    const auto block = static_cast<std::size_t>(k);
    excess[k] = effects.score.segment(effects.at[block], effects.size(block)).squaredNorm() -
                BlockOf(effects.S, effects.at, block, block).trace();
    least[k] = N(k, k) > 0 ? 0.3 * std::sqrt(2 / N(k, k)) : 0.0;
  }
  for (int sweep = 0; sweep < kSweeps; ++sweep)
    for (Eigen::Index k = 0; k < count; ++k)
      if (N(k, k) > 0) variance[k] = std::max(least[k], variance[k] + (excess[k] - N.row(k).dot(variance)) / N(k, k));
  return {variance.begin(), variance.end()};
}

SeenEffects SeenOf(const RandomEffects& effects, const std::vector<double>& variance) {
  SeenEffects seen;
  seen.axes.resize(effects.blocks());
  ParallelFor(effects.blocks(), [&](std::size_t k) {
    if (effects.size(k) == 0) return;  // the solver takes no empty matrix
    const Eigen::SelfAdjointEigenSolver<MatrixXd> axes(BlockOf(effects.S, effects.at, k, k));
    const auto tells = (axes.eigenvalues().array() * variance[k] > kUnseen).count();
    seen.axes[k] = axes.eigenvectors().rightCols(tells);
  });
  seen.along.at = {0};
  for (const MatrixXd& axes : seen.axes) seen.along.at.push_back(seen.along.at.back() + static_cast<int>(axes.cols()));
  seen.along.S.resize(seen.along.at.back(), seen.along.at.back());
  seen.along.score.resize(seen.along.at.back());
  ParallelFor(effects.blocks(), [&](std::size_t k) {
    const MatrixXd& axes = seen.axes[k];
    seen.along.score.segment(seen.along.at[k], axes.cols()) =
        axes.transpose() * effects.score.segment(effects.at[k], axes.rows());
    const MatrixXd rows = axes.transpose() * effects.S.middleRows(effects.at[k], axes.rows());
    for (std::size_t l = 0; l < seen.axes.size(); ++l)
      seen.along.S.block(seen.along.at[k], seen.along.at[l], axes.cols(), seen.axes[l].cols()) =
          rows.middleCols(effects.at[l], seen.axes[l].rows()) * seen.axes[l];
  });
  return seen;
}

VectorXd RootsOf(const std::vector<double>& variance, const std::vector<int>& at) {
  VectorXd roots(at.back());
  for (std::size_t k = 0; k < variance.size(); ++k)
    roots.segment(at[k], at[k + 1] - at[k]).setConstant(std::sqrt(variance[k]));
  return roots;
}

// L^-1, lower triangular, block column by block column.
MatrixXd InverseOf(const MatrixXd& L, const std::vector<int>& at) {
  MatrixXd inverse = MatrixXd::Zero(L.rows(), L.cols());
  ParallelFor(at.size() - 1, [&](std::size_t k) {
    const Eigen::Index from = at[k], width = at[k + 1] - from, height = L.rows() - from;
    MatrixXd columns = MatrixXd::Identity(height, width);
    L.bottomRightCorner(height, height).triangularView<Eigen::Lower>().solveInPlace(columns);
    inverse.block(from, from, height, width) = columns;
  });
  return inverse;
}

// What one block says at the present variances.
struct BlockState {
  double squares = 0.0, dof = 0.0, information = 0.0, evidence = 0.0;
};
BlockState StateOf(const Components& now, const VectorXd& a, std::size_t k) {
  const std::vector<int>& at = now.seen.along.at;
  const Eigen::Index from = at[k], width = at[k + 1] - from;
  if (width == 0) return {};
  const MatrixXd columns = now.inverse_L.block(from, from, now.inverse_L.rows() - from, width);
  const MatrixXd inverse = columns.transpose() * columns;  // (B^-1)_kk
  const VectorXd a_k = a.segment(from, width);
  const Eigen::LLT<MatrixXd> llt(inverse);
  BlockState state;
  state.squares = a_k.squaredNorm();
  state.dof = static_cast<double>(width) - inverse.trace();
  state.information = (MatrixXd::Identity(width, width) - inverse).squaredNorm();
  state.evidence = a_k.dot(llt.solve(a_k)) + 2 * llt.matrixLLT().diagonal().array().log().sum();
  return state;
}

// All that follows from the variances; the states of the blocks.
std::vector<BlockState> Evaluate(Components& now) {
  const RandomEffects& along = now.seen.along;
  const VectorXd roots = RootsOf(now.variance, along.at);
  MatrixXd B = roots.asDiagonal() * along.S * roots.asDiagonal();
  B.diagonal().array() += 1.0;
  const Eigen::LLT<Eigen::Ref<MatrixXd>> llt(B);
  now.inverse_L = InverseOf(B, along.at);
  const VectorXd score = roots.cwiseProduct(along.score);
  const VectorXd a = llt.solve(score);
  const double log_det = 2 * B.diagonal().array().log().sum();
  now.complexity = a.squaredNorm() + log_det;
  std::vector<BlockState> states(now.variance.size());
  ParallelFor(states.size(), [&](std::size_t k) { states[k] = StateOf(now, a, k); });
  const VectorXd mean = -roots.cwiseProduct(a);
  for (std::size_t k = 0; k < states.size(); ++k) {
    now.evidence[k] = std::max(0.0, states[k].evidence);
    now.dof[k] = states[k].dof;
  }
  Eigen::Index row = 0;
  for (std::size_t k = 0; k < states.size(); ++k) {
    const MatrixXd& axes = now.seen.axes[k];
    now.mean.segment(row, axes.rows()) = axes * mean.segment(along.at[k], axes.cols());
    row += axes.rows();
  }
  return states;
}

// Fisher scoring, block by block; true where no variance moves by more than a little of its own sigma.
bool NextVariances(const std::vector<BlockState>& states, std::vector<double>& variance) {
  bool settled = true;
  for (std::size_t k = 0; k < states.size(); ++k) {
    const BlockState& state = states[k];
    if (variance[k] == 0 || state.information <= 0) continue;
    const double sigma = variance[k] * std::sqrt(2 / state.information);
    const double wanted = variance[k] + variance[k] * (state.squares - state.dof) / state.information;
    const double next = std::clamp(wanted, variance[k] / kStepMax, variance[k] * kStepMax);
    settled &= std::abs(next - variance[k]) < kVarianceSettled * sigma;
    variance[k] = next < kVarianceSettled * sigma ? 0.0 : next;
  }
  return settled;
}

// sqrt(variance) times the columns of the block that are seen.
MatrixXd AlongSeen(const Components& components, std::size_t block, const MatrixXd& by_block) {
  return std::sqrt(components.variance[block]) * by_block * components.seen.axes[block];
}

Eigen::Index WidthOf(const Components& components, std::size_t block) { return components.seen.axes[block].rows(); }

}  // namespace

Components EstimateComponents(const RandomEffects& effects) {
  Components now;
  now.variance = VarianceByMoments(effects);
  now.evidence.assign(effects.blocks(), 0.0);
  now.dof.assign(effects.blocks(), 0.0);
  now.mean = VectorXd::Zero(effects.score.size());
  now.seen = SeenOf(effects, now.variance);
  for (int iteration = 0; iteration < kVarianceRoundsMax; ++iteration)
    if (NextVariances(Evaluate(now), now.variance)) break;
  Evaluate(now);
  return now;
}

MatrixXd PriorThrough(const Components& components, const MatrixXd& by) {
  MatrixXd sum = MatrixXd::Zero(by.rows(), by.rows());
  Eigen::Index at = 0;
  for (std::size_t k = 0; k < components.variance.size(); ++k) {
    const auto columns = by.middleCols(at, WidthOf(components, k));
    if (components.variance[k] > 0) sum.noalias() += components.variance[k] * columns * columns.transpose();
    at += columns.cols();
  }
  return sum;
}

// What is not seen is as it was before: D. Over the rest sqrt(D) B^-1 sqrt(D).
MatrixXd PosteriorThrough(const Components& components, const MatrixXd& by) {
  const std::vector<int>& seen_at = components.seen.along.at;
  if (seen_at.back() == 0) return PriorThrough(components, by);  // products take no empty matrix
  MatrixXd along(by.rows(), seen_at.back());
  Eigen::Index at = 0;
  for (std::size_t k = 0; k < components.variance.size(); ++k) {
    const Eigen::Index width = WidthOf(components, k);
    along.middleCols(seen_at[k], seen_at[k + 1] - seen_at[k]) = AlongSeen(components, k, by.middleCols(at, width));
    at += width;
  }
  const MatrixXd half = components.inverse_L.triangularView<Eigen::Lower>() * along.transpose();
  return PriorThrough(components, by) - along * along.transpose() + half.transpose() * half;
}

MatrixXd PosteriorThrough(const Components& components, std::size_t block, const MatrixXd& by_block) {
  const std::vector<int>& seen_at = components.seen.along.at;
  const Eigen::Index from = seen_at[block], below = components.inverse_L.rows() - from;
  const MatrixXd along = AlongSeen(components, block, by_block);
  const MatrixXd half = components.inverse_L.block(from, from, below, along.cols()) * along.transpose();
  return components.variance[block] * by_block * by_block.transpose() - along * along.transpose() +
         half.transpose() * half;
}

}  // namespace rigcal::calib::joint
