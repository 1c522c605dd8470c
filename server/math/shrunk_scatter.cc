#include "server/math/shrunk_scatter.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

#include "server/math/statistics.h"

namespace rigcal {
namespace {

using Eigen::MatrixXd;

// What chance makes in 95 of 100 cases is taken for chance.
constexpr double kChance = 0.95, kChanceSigmas = 1.645;

MatrixXd AtLeastOne(const MatrixXd& S) {
  const Eigen::SelfAdjointEigenSolver<MatrixXd> axes(S);
  return axes.eigenvectors() * axes.eigenvalues().cwiseMax(1.0).asDiagonal() * axes.eigenvectors().transpose();
}

// Squared distance of the terms from their mean, per dimension.
double Noise(const MatrixXd& y) {
  const MatrixXd mean = y * y.transpose() / static_cast<double>(y.cols());
  double noise = 0.0;
  for (Eigen::Index g = 0; g < y.cols(); ++g)
    noise += (y.col(g) * y.col(g).transpose() - mean).squaredNorm() / static_cast<double>(y.rows());
  return noise;
}

// How much further than by Noise chance takes S from its mean: independent terms have products x = y_g . y_h, whose
// squares have the variance 2 E[x^2]^2, which is 2/3 E[x^4].
double NoiseByChance(const MatrixXd& y) {
  MatrixXd products = y.transpose() * y;
  products.diagonal().setZero();
  return kChanceSigmas * 2 * std::sqrt(products.array().pow(4).sum() / 3) / static_cast<double>(y.rows());
}

// Of each pose, as it comes out: how many times as large as the model's is what S makes of its six rows.
Eigen::VectorXd FactorsOf(const MatrixXd& S, const MatrixXd& L) {
  const MatrixXd scattered = L * S * L.transpose(), model = L * L.transpose();
  Eigen::VectorXd factors(S.rows() / 6);
  for (Eigen::Index s = 0; s < factors.size(); ++s) {
    const Eigen::Matrix<double, 6, 6> of_model = model.block<6, 6>(6 * s, 6 * s);
    factors[s] = of_model.llt().solve(scattered.block<6, 6>(6 * s, 6 * s)).trace() / 6;
  }
  return factors;
}

// `by_chance`: the variance that chance makes of each.
Eigen::VectorXd DrawnTogether(const Eigen::VectorXd& factors, double by_chance) {
  const double mean = factors.mean(), freedom = std::max<double>(1.0, factors.size() - 1.0);
  const double unlike = (factors.array() - mean).square().sum() / freedom;
  const double usual = by_chance * ChiSquareQuantile(kChance, freedom) / freedom;
  const double together = unlike > 0 ? std::min(1.0, usual / unlike) : 1.0;
  return mean + (1 - together) * (factors.array() - mean);
}

}  // namespace

ShrunkScatter ShrinkScatterOfPoses(const MatrixXd& y, const MatrixXd& L, const MatrixXd& known) {
  MatrixXd S = y * y.transpose();
  const auto groups = static_cast<double>(y.cols()), rows = static_cast<double>(y.rows());
  const double of_groups = S.trace() / rows;
  if (known.size() > 0) S += known;
  ShrunkScatter shrunk;
  shrunk.mean = S.trace() / rows;
  const Eigen::VectorXd factors = DrawnTogether(FactorsOf(S, L), of_groups * of_groups / (3 * groups)).cwiseMax(1.0);
  const Eigen::VectorXd by_row = factors.cwiseSqrt().transpose().replicate(6, 1).reshaped();
  const MatrixXd half = L.triangularView<Eigen::Lower>().solve(by_row.asDiagonal() * L);
  const MatrixXd target = half * half.transpose();
  const double spread = (S - target).squaredNorm() / rows;
  if (y.cols() >= 2 && spread > 0)
    shrunk.model_ratio = std::min(1.0, (groups / (groups - 1) * Noise(y) + NoiseByChance(y)) / spread);
  shrunk.S = AtLeastOne(shrunk.model_ratio * target + (1 - shrunk.model_ratio) * S);
  return shrunk;
}

ShrunkScatter ShrinkScatter(const MatrixXd& y, const MatrixXd& known) {
  const MatrixXd one = MatrixXd::Identity(y.rows(), y.rows());
  MatrixXd S = y * y.transpose();
  if (known.size() > 0) S += known;
  ShrunkScatter shrunk;
  shrunk.mean = S.trace() / static_cast<double>(y.rows());
  const double spread = (S - shrunk.mean * one).squaredNorm() / static_cast<double>(y.rows());
  if (y.cols() >= 2 && spread > 0) shrunk.model_ratio = std::min(1.0, Noise(y) / spread);
  shrunk.S = AtLeastOne(shrunk.model_ratio * std::max(1.0, shrunk.mean) * one + (1 - shrunk.model_ratio) * S);
  return shrunk;
}

}  // namespace rigcal
