#include "server/calib/joint/misfit/contradicted_pairs.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <vector>

#include "server/calib/joint/misfit/instrument_effects.h"
#include "server/calib/joint/problem/observation.h"
#include "server/math/statistics.h"

namespace rigcal::calib::joint {
namespace {

constexpr double kAlone = 1e-6;  // of a direction's variance: less is left by rounding where nothing else tells it
constexpr double kSingularRatio = 1e-12;  // of the largest information

// Square root of a symmetric matrix, and nothing along what it does not tell.
Matrix6d RootOf(const Matrix6d& A) {
  const Eigen::SelfAdjointEigenSolver<Matrix6d> axes(A);
  const double least = kSingularRatio * axes.eigenvalues()[5];
  const Vector6d root =
      axes.eigenvalues().unaryExpr([&](double value) { return value > least ? std::sqrt(value) : 0; });
  return axes.eigenvectors() * root.asDiagonal() * axes.eigenvectors().transpose();
}

// Covariance of the residual's own tangent, by that of the unknowns.
Matrix6d ByUnknowns(const Observation& look, const Eigen::MatrixXd& covariance) {
  Matrix6d C = Matrix6d::Zero();
  for (const Column& row : look.columns)
    for (const Column& column : look.columns)
      if (row.at + 6 <= covariance.rows() && column.at + 6 <= covariance.rows())  // the reference does not move
        C += row.by * covariance.block(row.at, column.at, 6, 6) * column.by.transpose();
  return C;
}

double TailOf(double t_squared, int rank, int dof) {
  if (dof == 0) return ChiSquareTail(t_squared, rank);
  const int left = dof - rank + 1;
  return left < 1 ? 1.0 : FisherTail(t_squared * left / (static_cast<double>(rank) * dof), rank, left);
}

// `beside`: what lenses, lidars and boards may do to the unknowns beyond their models.
double OddsOf(const Refined& refined, const Eigen::MatrixXd& beside, const RelativeKnown& known) {
  const Observation look = Observe(refined.layout, refined.state, known);
  const Matrix6d root = RootOf(look.A);
  // b = A x of the residual x in its own tangent; root^+ b = root x.
  return OddsOfResidual(root.completeOrthogonalDecomposition().solve(look.b),
                        root * ByUnknowns(look, refined.covariance) * root, root * ByUnknowns(look, beside) * root,
                        known.dof);
}

Eigen::MatrixXd CovarianceBeside(const Explained& now) {
  Eigen::MatrixXd covariance = Eigen::MatrixXd::Zero(now.refined.layout.size, now.refined.layout.size);
  for (const Eigen::MatrixXd& beside : {CovarianceByFields(now.misfits), CovarianceByInstruments(now)})
    if (beside.size() > 0) covariance += beside;
  return covariance;
}

Vector6d OffOf(const SessionState& state, const RelativeKnown& known) {
  const Se3 T_a_b = state.T_ref_sensor[static_cast<std::size_t>(known.sensor_a)].Inverse() *
                    state.T_ref_sensor[static_cast<std::size_t>(known.sensor_b)];
  return (known.T_a_b.Inverse() * T_a_b).Log();
}

}  // namespace

double OddsOfResidual(const Vector6d& z, const Matrix6d& leverage, const Matrix6d& beside, int dof) {
  const Eigen::SelfAdjointEigenSolver<Matrix6d> axes(leverage);
  std::vector<int> checked;
  for (int i = 0; i < 6; ++i)
    if (const double left = 1 - axes.eigenvalues()[i]; left > kAlone && left < 1.0) checked.push_back(i);
  if (checked.empty()) return 1.0;
  const Eigen::MatrixXd V = axes.eigenvectors()(Eigen::all, checked);
  const Eigen::VectorXd left = 1 - axes.eigenvalues()(checked).array();
  const Eigen::MatrixXd variance = Eigen::MatrixXd(left.asDiagonal()) + V.transpose() * beside * V;
  const Eigen::VectorXd along = V.transpose() * z;
  return TailOf(along.dot(variance.ldlt().solve(along)), static_cast<int>(checked.size()), dof);
}

Explained WithoutContradictedPairs(Explained now, SessionEstimate& told) {
  while (true) {
    const std::vector<RelativeKnown>& known = now.start.problem.relatives;
    if (known.empty()) return now;
    const Eigen::MatrixXd beside = CovarianceBeside(now);
    std::vector<double> odds;
    for (const RelativeKnown& one : known)
      odds.push_back(OddsOf(now.refined, beside, one) * static_cast<double>(known.size()));
    const auto worst = std::min_element(odds.begin(), odds.end());
    if (*worst >= kMovedOdds) return now;
    const RelativeKnown gone = known[static_cast<std::size_t>(worst - odds.begin())];
    SessionStart start = now.start;
    start.problem.relatives.erase(start.problem.relatives.begin() + (worst - odds.begin()));
    start.state = now.refined.state;
    start.noise = now.refined.noise;
    auto next = Explain(std::move(start), now.refined.groups);
    if (!next) return now;  // without it the poses are not told
    now = std::move(*next);
    const auto name = [&](int sensor) { return now.start.problem.sensors[static_cast<std::size_t>(sensor)]; };
    told.contradicted.push_back({name(gone.sensor_a), name(gone.sensor_b), OffOf(now.refined.state, gone), *worst});
  }
}

}  // namespace rigcal::calib::joint
