#include "server/graph/fusion/joined_information.h"

#include <Eigen/Eigenvalues>
#include <Eigen/QR>
#include <algorithm>
#include <cmath>

#include "server/math/covariance.h"

namespace rigcal::graph {
namespace {

constexpr double kNoiseFactor = 3.0, kNoiseMin_rad = 1e-5, kNoiseMax_rad = 0.03;

// On what this measurement leaves open, in scaled units: an orthogonal projector.
Matrix6d OntoOpen(const FreeBasis& open, const Vector6d& scale) {
  if (open.cols() == 0) return Matrix6d::Zero();
  const Eigen::MatrixXd scaled = scale.cwiseInverse().asDiagonal() * open;
  const Eigen::MatrixXd Q =
      Eigen::HouseholderQR<Eigen::MatrixXd>(scaled).householderQ() * Eigen::MatrixXd::Identity(6, open.cols());
  return Q * Q.transpose();
}

}  // namespace

Matrix6d JoinedInformation(const Matrix6d& A, const Matrix6d& B, double noise_rad, double length_m) {
  const Matrix6d sum = A + B;
  const FreeBasis open_a = Observable(A).unobservable_basis, open_b = Observable(B).unobservable_basis;
  if (open_a.cols() == 0 || open_b.cols() == 0) return sum;
  const Vector6d scale = EachAxis(length_m > 0 ? length_m : 1.0, 1.0);
  const Matrix6d seen = 2 * Matrix6d::Identity() - OntoOpen(open_a, scale) - OntoOpen(open_b, scale);
  const Eigen::SelfAdjointEigenSolver<Matrix6d> eigen(seen);
  const double noise = kNoiseFactor * std::clamp(noise_rad, kNoiseMin_rad, kNoiseMax_rad);
  Eigen::Index open = 0;
  while (open < 6 && eigen.eigenvalues()(open) <= noise * noise) ++open;
  const Eigen::MatrixXd N = eigen.eigenvectors().leftCols(open);
  const Matrix6d across = Matrix6d::Identity() - N * N.transpose();
  const Matrix6d Q = scale.asDiagonal() * across * scale.cwiseInverse().asDiagonal();
  return Symmetrized(Q.transpose() * sum * Q);
}

}  // namespace rigcal::graph
