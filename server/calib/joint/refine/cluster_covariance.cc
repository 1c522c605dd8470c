#include "server/calib/joint/refine/cluster_covariance.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <cmath>

#include "server/base/process/parallel_for.h"
#include "server/math/pooled_dof.h"
#include "server/math/shrunk_scatter.h"

namespace rigcal::calib::joint {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

// Symmetric but for rounding.
MatrixXd Selected(const MatrixXd& matrix, const std::vector<int>& rows) { return matrix(rows, rows).transpose(); }

std::vector<int> PoseRows(const Refined& refined, std::vector<int>& row_of_sensor) {
  std::vector<int> rows;
  for (const int at : refined.layout.pose) {
    const bool held = at >= refined.layout.size;
    row_of_sensor.push_back(held ? kNone : static_cast<int>(rows.size()));
    for (int i = 0; i < 6 && !held; ++i) rows.push_back(at + i);
  }
  return rows;
}

// L^-1 H_g L^-T v, the leverage M of a group on whitened unknowns.
class Leverage {
 public:
  Leverage(const Eigen::LLT<MatrixXd>& H, const VectorXd& scale, const MatrixXd& group)
      : H_(H), scaled_(scale.asDiagonal() * group * scale.asDiagonal()) {}
  [[nodiscard]] VectorXd operator*(const VectorXd& v) const {
    const VectorXd by_group = scaled_ * H_.matrixU().solve(v);
    return H_.matrixL().solve(by_group);
  }

 private:
  const Eigen::LLT<MatrixXd>& H_;
  MatrixXd scaled_;
};

// A group that alone holds a direction says nothing of its scatter there.
double UnbiasedFactor(double leverage) {
  constexpr double kAlone = 1e-6;
  return 1 - leverage > kAlone ? 1 / std::sqrt(1 - leverage) : 0.0;
}

// (I - M)^-1/2 z: a group's residuals are too small by what it pulled the optimum towards itself (Bell & McCaffrey
// 2002). By Lanczos from z, M being of low rank: in the basis Q of its powers M is tridiagonal, and the function of it
// times z is |z| Q f(Q^T M Q) e_1 (Higham, Functions of Matrices, 13.2), exact once the powers are spent.
VectorXd Unbiased(const Leverage& M, const VectorXd& z) {
  constexpr double kSpent = 1e-13, kEnough = 1e-12;  // of whitened unknowns, and of the result
  constexpr Eigen::Index kBetweenLooks = 4;
  const double length = z.norm();
  if (length == 0.0) return z;
  const Eigen::Index most = z.size();
  MatrixXd Q(most, most);
  VectorXd alpha(most), beta(most), coefficients;
  Q.col(0) = z / length;
  for (Eigen::Index k = 1;; ++k) {
    VectorXd next = M * Q.col(k - 1);
    alpha[k - 1] = Q.col(k - 1).dot(next);
    for (int twice = 0; twice < 2; ++twice) next -= Q.leftCols(k) * (Q.leftCols(k).transpose() * next);
    beta[k - 1] = next.norm();
    const bool spent = k == most || beta[k - 1] < kSpent;
    if (spent || k % kBetweenLooks == 0) {
      Eigen::SelfAdjointEigenSolver<MatrixXd> axes;
      axes.computeFromTridiagonal(alpha.head(k), beta.head(k - 1));
      const VectorXd factor = axes.eigenvalues().unaryExpr([](double leverage) { return UnbiasedFactor(leverage); });
      const VectorXd now = axes.eigenvectors() * factor.cwiseProduct(axes.eigenvectors().row(0).transpose());
      coefficients.conservativeResizeLike(VectorXd::Zero(k));
      const bool enough = (now - coefficients).norm() <= kEnough * now.norm();
      coefficients = now;
      if (spent || enough) return length * (Q.leftCols(k) * coefficients);
    }
    Q.col(k) = next / beta[k - 1];
  }
}

// Scores of the groups, whitened by the whole information.
MatrixXd WhitenedScores(const Refined& refined, const Eigen::LLT<MatrixXd>& H, const VectorXd& scale) {
  const int size = refined.layout.size;
  const auto& groups = refined.at_optimum.groups;
  MatrixXd scores(size, static_cast<Eigen::Index>(groups.size()));
  ParallelFor(groups.size(), [&](std::size_t g) {
    const VectorXd z = H.matrixL().solve(scale.cwiseProduct(groups[g].b.head(size)));
    scores.col(static_cast<Eigen::Index>(g)) = Unbiased(Leverage(H, scale, groups[g].H.topLeftCorner(size, size)), z);
  });
  return scores;
}

// Of the information that is given, that of constants; the rest relates poses.
MatrixXd OfConstants(MatrixXd given, const std::vector<int>& pose_rows) {
  for (const int row : pose_rows) {
    given.row(row).setZero();
    given.col(row).setZero();
  }
  return given;
}

double DofOf(const MatrixXd& joint, const MatrixXd& influence, double share, int row) {
  const Matrix6d all = joint.block<6, 6>(row, row);
  PooledDof pooled(all);
  const Eigen::Matrix<double, 6, Eigen::Dynamic> columns = std::sqrt(share) * influence.middleRows<6>(row);
  pooled.AddBlocks(columns, static_cast<int>(influence.cols()) - 1);
  return pooled.Of(all);
}

}  // namespace

PoseCovariance CovarianceOfPoses(const Refined& refined, const MatrixXd& beside, const MatrixXd& of_visit) {
  const int size = refined.layout.size;
  PoseCovariance result;
  const std::vector<int> rows = PoseRows(refined, result.row_of_sensor);
  const MatrixXd H = refined.at_optimum.total.H.topLeftCorner(size, size);
  const VectorXd scale = H.diagonal().cwiseSqrt().cwiseInverse();
  const Eigen::LLT<MatrixXd> llt(scale.asDiagonal() * H * scale.asDiagonal());
  // Poses moved by a whitened score z: scale L^-T z.
  const MatrixXd unwhiten = scale.asDiagonal() * llt.matrixU().solve(MatrixXd::Identity(size, size));
  const MatrixXd poses = unwhiten(rows, Eigen::all);
  result.model = poses * poses.transpose();
  result.influence = poses * WhitenedScores(refined, llt, scale);
  const VectorXd pose_scale = result.model.diagonal().cwiseSqrt().cwiseInverse();
  const Eigen::LLT<MatrixXd> of_model(pose_scale.asDiagonal() * result.model * pose_scale.asDiagonal());
  const MatrixXd y = of_model.matrixL().solve(pose_scale.asDiagonal() * result.influence);
  const MatrixXd given_H = refined.at_optimum.given.H.topLeftCorner(size, size);
  const MatrixXd given = Selected(refined.covariance * given_H * refined.covariance, rows);
  result.common = Selected(refined.covariance * OfConstants(given_H, rows) * refined.covariance, rows);
  const MatrixXd half = of_model.matrixL().solve(pose_scale.asDiagonal() * given * pose_scale.asDiagonal());
  const MatrixXd known = of_model.matrixL().solve(half.transpose());
  const ShrunkScatter shrunk = ShrinkScatterOfPoses(y, of_model.matrixL(), known);
  const MatrixXd L = pose_scale.cwiseInverse().asDiagonal() * MatrixXd(of_model.matrixL());
  result.joint = result.without_beside = L * shrunk.S * L.transpose();
  if (beside.size() > 0) {
    result.joint += Selected(beside, rows);
    result.common += Selected(beside, rows);  // a lens is the same on every visit
  }
  if (of_visit.size() > 0) result.joint += Selected(of_visit, rows);
  result.model_ratio = shrunk.model_ratio;
  result.spread_ratio = shrunk.mean;
  for (const int row : result.row_of_sensor)
    result.dof.push_back(row == kNone ? 0.0 : DofOf(result.joint, result.influence, 1 - shrunk.model_ratio, row));
  return result;
}

}  // namespace rigcal::calib::joint
