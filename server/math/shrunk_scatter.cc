#include "server/math/shrunk_scatter.h"

#include <Eigen/Eigenvalues>
#include <algorithm>

namespace rigcal {
namespace {

using Eigen::MatrixXd;

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

}  // namespace

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
