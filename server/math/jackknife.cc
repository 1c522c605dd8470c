#include "server/math/jackknife.h"

#include <Eigen/Cholesky>
#include <Eigen/QR>
#include <cmath>
#include <cstdio>
#include <cstdlib>

#include "server/math/covariance.h"
#include "server/math/shrunk_scatter.h"

namespace rigcal {
namespace {

// Our own caller decides how many blocks there are: fewer is a broken invariant.
void Require(bool ok, const char* what) {
  if (ok) return;
  std::fprintf(stderr, "rigcal: jackknife needs %s\n", what);
  std::abort();
}

using Columns = Eigen::Matrix<double, 6, Eigen::Dynamic>;

// Their sum of squares is the jackknife's covariance.
Columns CentredBlocks(const std::vector<Vector6d>& d) {
  const auto m = static_cast<Eigen::Index>(d.size());
  Columns columns(6, m);
  for (Eigen::Index i = 0; i < m; ++i) columns.col(i) = d[static_cast<std::size_t>(i)];
  const Vector6d mean = columns.rowwise().mean();
  return std::sqrt(1.0 - 1.0 / static_cast<double>(m)) * (columns.colwise() - mean);
}

// Orthonormal columns along which C says something.
Columns Seen(const Matrix6d& C) {
  const Columns unseen = Observable(C).unobservable_basis;
  if (unseen.cols() == 0) return Matrix6d::Identity();
  const Matrix6d Q = Eigen::HouseholderQR<Columns>(unseen).householderQ();
  return Q.rightCols(6 - unseen.cols());
}

}  // namespace

Matrix6d JackknifeCovariance(const std::vector<Vector6d>& d) {
  Require(d.size() >= 2, "at least two blocks");
  const Columns columns = CentredBlocks(d);
  return columns * columns.transpose();
}

Matrix6d JackknifeOrModel(const std::vector<Vector6d>& d, const Matrix6d& C_model) {
  Require(d.size() >= 2, "at least two blocks");
  const Columns B = Seen(C_model);
  const Eigen::MatrixXd along = B.transpose() * C_model * B;
  const Eigen::VectorXd sigma = along.diagonal().cwiseSqrt();
  const Eigen::MatrixXd scaled = sigma.cwiseInverse().asDiagonal() * along * sigma.cwiseInverse().asDiagonal();
  const Eigen::LLT<Eigen::MatrixXd> llt(scaled);
  const Eigen::MatrixXd y = llt.matrixL().solve(sigma.cwiseInverse().asDiagonal() * (B.transpose() * CentredBlocks(d)));
  const Eigen::MatrixXd L = B * sigma.asDiagonal() * Eigen::MatrixXd(llt.matrixL());
  return Symmetrized(L * ShrinkScatter(y).S * L.transpose());
}

}  // namespace rigcal
