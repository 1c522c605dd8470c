#include "server/graph/fusion/next_visit.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

#include "server/graph/fusion/visit_ages.h"
#include "server/math/pooled_dof.h"

namespace rigcal::graph {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

// A variance alike along three axes, from n numbers, twice, or six variances, each from n: as sure as a 6 x 6
// covariance of so many times n degrees of freedom (the same expected error in PooledDof's measure: of 3 numbers 42 /
// 4).
constexpr double kMatrixDofPerNumber = 10.0 / 3.0;
// 0: it is known; however little tells it, it is not.
int MatrixDofOf(const ScatterDof& numbers) {
  const double least = std::min(numbers.translation, numbers.rotation);
  return least > 0 ? static_cast<int>(std::lround(std::clamp(kMatrixDofPerNumber * least, 1.0, 1e6))) : 0;
}

// Symmetric root of a covariance of mixed units: with alike sources and alike geometry it is alike on every visit.
MatrixXd RootOf(const MatrixXd& C) {
  const VectorXd scale = C.diagonal().unaryExpr([](double c) { return c > 0 ? std::sqrt(c) : 1.0; });
  const Eigen::SelfAdjointEigenSolver<MatrixXd> axes(scale.cwiseInverse().asDiagonal() * C *
                                                     scale.cwiseInverse().asDiagonal());
  return scale.asDiagonal() * axes.eigenvectors() * axes.eigenvalues().cwiseMax(0.0).cwiseSqrt().asDiagonal() *
         axes.eigenvectors().transpose();
}

MatrixXd CommonPart(const SessionFusion& fusion, const Gains& gains) {
  const Eigen::Index size = fusion.Size();
  MatrixXd moved =
      MatrixXd::Zero(size, size + 6);  // by what is common, a source per row of a sensor; the last: the reference
  MatrixXd counted = MatrixXd::Zero(size, size);  // of it in the inverse already, as if visits erred apart
  for (std::size_t k = 0; k < fusion.factors.size(); ++k) {
    const SessionFactor& factor = fusion.factors[k];
    if (factor.common.rows() == 0) continue;
    const MatrixXd& G = gains.of_sessions[k];
    const MatrixXd by = G * RootOf(factor.common);
    counted += G * factor.common * G.transpose();
    for (std::size_t i = 0; i < factor.variable.size(); ++i)
      moved.middleCols<6>(factor.variable[i] == kFixed ? size : 6 * factor.variable[i]) +=
          by.middleCols<6>(6 * static_cast<Eigen::Index>(i));
  }
  return moved * moved.transpose() - counted;
}

// Behind `all` of one sensor, of which its scatter is a part and so much is for the walk.
double DofOf(const SessionFusion& fusion, const Gains& gains, const FusionDof& dof, std::size_t sensor,
             const Matrix6d& all, const Matrix6d& by_walk) {
  PooledDof pooled(all);
  for (std::size_t k = 0; k < fusion.factors.size(); ++k) {
    const SessionFactor& factor = fusion.factors[k];
    const MatrixXd G = gains.of_sessions[k].middleRows<6>(6 * static_cast<Eigen::Index>(sensor));
    double of_session = *std::min_element(factor.dof.begin(), factor.dof.end());
    for (std::size_t i = 0; i < factor.variable.size(); ++i)
      if (factor.variable[i] == static_cast<int>(sensor)) of_session = factor.dof[i];
    pooled.Add(G * factor.C * G.transpose(), static_cast<int>(std::lround(of_session)));
  }
  pooled.Add(fusion.scatter[sensor].Matrix(), MatrixDofOf(dof.scatter[sensor]));
  pooled.Add(by_walk, MatrixDofOf(dof.walk[sensor]));
  return pooled.Of(all);
}

}  // namespace

NextVisit NextVisitOf(const SessionFusion& fusion, const MatrixXd& inverse, const FusionDof& dof) {
  const auto rows = 6 * static_cast<Eigen::Index>(fusion.sensors.size());
  const Gains gains = GainsOf(fusion, inverse);
  NextVisit next{(inverse + CommonPart(fusion, gains)).topLeftCorner(rows, rows), {}};
  const double days = DaysUntilNext(fusion);
  for (std::size_t s = 0; s < fusion.sensors.size(); ++s) {
    const auto row = 6 * static_cast<Eigen::Index>(s);
    const Matrix6d walk_on = days * fusion.walk[s].Matrix();
    next.covariance.block<6, 6>(row, row) += fusion.scatter[s].Matrix() + walk_on;
    next.dof.push_back(DofOf(fusion, gains, dof, s, next.covariance.block<6, 6>(row, row),
                             gains.by_walk.block<6, 6>(row, row) + walk_on));
  }
  return next;
}

}  // namespace rigcal::graph
