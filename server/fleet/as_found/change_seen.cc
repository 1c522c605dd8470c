#include "server/fleet/as_found/change_seen.h"

#include <Eigen/Cholesky>
#include <Eigen/QR>
#include <algorithm>
#include <cmath>

namespace rigcal::fleet {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double kSaysNothing = 1.0;     // sigma, m or rad
constexpr double kNamedGain = 9.2;       // twice the log of a hundred
constexpr double kOpenDirection = 1e-9;  // share of the largest pivot

// Of a scatter that is an estimate, too large or too small by chance, zero included: as sure as the whole then is.
double NotMoreThanOfScatter(double dof, double of_scatter) {
  if (of_scatter <= 0) return dof;
  return dof > 0 ? std::min(dof, of_scatter) : of_scatter;
}

// What was measured of the change: rows, and their information.
struct MeasuredChange {
  std::vector<Index> rows;
  VectorXd change;
  MatrixXd W;
};
MeasuredChange MeasuredOf(const ChangeSeen& seen) {
  MeasuredChange measured;
  for (Index row = 0; row < seen.change.size(); ++row)
    if (seen.IsMeasured(row)) measured.rows.push_back(row);
  measured.change = seen.change(measured.rows);
  const MatrixXd S = seen.covariance(measured.rows, measured.rows);
  const VectorXd scale = S.diagonal().cwiseSqrt().cwiseInverse();
  const MatrixXd inverse =
      (scale.asDiagonal() * S * scale.asDiagonal()).ldlt().solve(MatrixXd::Identity(S.rows(), S.cols()));
  measured.W = scale.asDiagonal() * inverse * scale.asDiagonal();
  return measured;
}

// Of a step m of six numbers, change = E m, along the directions that show in it.
double GainOf(const MatrixXd& all_rows_of_E, const MeasuredChange& measured) {
  const MatrixXd E = all_rows_of_E(measured.rows, Eigen::all);
  const MatrixXd half = E.transpose() * measured.W;
  const Matrix6d information = half * E;
  const Vector6d scale = information.diagonal().unaryExpr([](double i) { return i > 0 ? 1.0 / std::sqrt(i) : 0.0; });
  const Vector6d b = scale.cwiseProduct(Vector6d(half * measured.change));
  Eigen::CompleteOrthogonalDecomposition<Matrix6d> solver;
  solver.setThreshold(kOpenDirection);
  solver.compute(scale.asDiagonal() * information * scale.asDiagonal());
  return b.dot(solver.solve(b));
}

struct Candidate {
  SensorId sensor;
  double gain = 0.0;
};
std::vector<Candidate> BestFirst(const ChangeSeen& seen) {
  const MeasuredChange measured = MeasuredOf(seen);
  const Index rows = seen.change.size();
  std::vector<Candidate> candidates;
  MatrixXd by_frame(rows, 6);  // a step of the frame moves all others by its inverse
  for (std::size_t s = 0; s < seen.sensors.size(); ++s) {
    const auto row = static_cast<Index>(6 * s);
    MatrixXd E = MatrixXd::Zero(rows, 6);
    E.middleRows<6>(row).setIdentity();
    by_frame.middleRows<6>(row) = -Adjoint(seen.T_frame_before[s].Inverse());
    candidates.push_back({seen.sensors[s], GainOf(E, measured)});
  }
  candidates.push_back({seen.frame, GainOf(by_frame, measured)});
  std::stable_sort(candidates.begin(), candidates.end(), [](const auto& x, const auto& y) { return x.gain > y.gain; });
  return candidates;
}

}  // namespace

double WelchDof(double a, double dof_a, double b, double dof_b) {
  const double scatter = (dof_a > 0 ? a * a / dof_a : 0.0) + (dof_b > 0 ? b * b / dof_b : 0.0);
  return scatter > 0.0 ? (a + b) * (a + b) / scatter : 0.0;
}

double ChangeSeen::Sigma(Index row) const { return std::sqrt(covariance(row, row)); }

bool ChangeSeen::IsMeasured(Index row) const {
  return covariance(row, row) > 0 && Sigma(row) <= kSaysNothing && std::isfinite(change(row));
}

ChangeSeen ChangeBetween(const SensorId& frame, const std::vector<SensorId>& sensors, const KnownPoses& before,
                         const KnownPoses& after) {
  const PosesSeen was = SeenFrom(frame, sensors, before), is = SeenFrom(frame, sensors, after);
  ChangeSeen seen{
      frame,       sensors, was.T_frame_sensor, VectorXd(was.covariance.rows()), was.covariance + is.covariance,
      was.assumed, {}};
  for (std::size_t s = 0; s < sensors.size(); ++s) {
    const auto first = static_cast<Index>(6 * s);
    seen.change.segment<6>(first) = (was.T_frame_sensor[s].Inverse() * is.T_frame_sensor[s]).Log();
    for (Index row = first; row < first + 6; ++row)
      seen.dof.push_back(
          NotMoreThanOfScatter(WelchDof(was.covariance(row, row), was.dof[s], is.covariance(row, row), is.dof[s]),
                               row < first + 3 ? was.scatter_dof[s].translation : was.scatter_dof[s].rotation));
  }
  return seen;
}

Mover LikeliestMover(const ChangeSeen& seen) {
  if (seen.sensors.size() == 1) return {seen.sensors.front(), seen.frame};
  const std::vector<Candidate> candidates = BestFirst(seen);
  const Candidate &best = candidates[0], &second = candidates[1];
  if (best.gain - second.gain >= kNamedGain) return {best.sensor};
  return best.sensor == seen.frame ? Mover{second.sensor, best.sensor} : Mover{best.sensor, second.sensor};
}

}  // namespace rigcal::fleet
