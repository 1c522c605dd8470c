#include "server/math/jackknife.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <boost/math/special_functions/gamma.hpp>
#include <cmath>
#include <cstdio>
#include <cstdlib>

#include "server/math/covariance.h"

namespace rigcal {
namespace {

// Our own caller decides how many blocks there are: fewer is a broken invariant.
void Require(bool ok, const char* what) {
  if (ok) return;
  std::fprintf(stderr, "rigcal: jackknife needs %s\n", what);
  std::abort();
}

constexpr double kModelWeightMin = 7.0;  // kappa, in blocks
// Fast: no long double.
using Quick = boost::math::policies::policy<boost::math::policies::promote_double<false>>;
constexpr int kWeights = 64;  // of which kappa is averaged; 1000 change the ratio by less than 0.001

// Eigenvalues of C_model^-1 C_jack along what C_model spans; about 1 where the blocks scatter as the model says.
Eigen::VectorXd RelativeEigenvalues(const Matrix6d& C_jack, const Matrix6d& C_model) {
  const ObservableSubspace model = Observable(C_model);
  const Matrix6d F = SquareRoot(model.covariance);  // F F^T = C_model^-1
  const Eigen::SelfAdjointEigenSolver<Matrix6d> eigen(Symmetrized(F.transpose() * C_jack * F));
  return eigen.eigenvalues().tail(model.rank).cwiseMax(0.0);
}

// Logarithm of the multivariate gamma function, but for a constant.
double LogGamma(double half_dof, Eigen::Index p) {
  double sum = 0.0;
  for (Eigen::Index i = 0; i < p; ++i) sum += boost::math::lgamma(half_dof - 0.5 * static_cast<double>(i), Quick());
  return sum;
}

// Of nu C_jack ~ Wishart(Sigma, nu) with Sigma integrated out, but for what does not depend on kappa.
double LogLikelihood(const Eigen::VectorXd& eigenvalues, double nu, double kappa) {
  const Eigen::Index p = eigenvalues.size();
  const double dof = kappa + static_cast<double>(p) + 1.0;
  return 0.5 * dof * static_cast<double>(p) * std::log(kappa) -
         0.5 * (dof + nu) * (kappa + nu * eigenvalues.array()).log().sum() + LogGamma(0.5 * (dof + nu), p) -
         LogGamma(0.5 * dof, p);
}

double PosteriorRatio(const Eigen::VectorXd& eigenvalues, int m) {
  const double nu = m - 1.0;
  if (!(nu > kModelWeightMin) || eigenvalues.size() == 0 || !(nu * eigenvalues).allFinite())
    return JackknifeRatioMax(m);
  Eigen::ArrayXd log_likelihood(kWeights), ratio(kWeights);
  for (int i = 0; i < kWeights; ++i) {
    const double kappa = kModelWeightMin * std::pow(nu / kModelWeightMin, (i + 0.5) / kWeights);
    log_likelihood[i] = LogLikelihood(eigenvalues, nu, kappa);
    ratio[i] = nu / (nu + kappa);
  }
  const Eigen::ArrayXd weight = (log_likelihood - log_likelihood.maxCoeff()).exp();
  return (weight * ratio).sum() / weight.sum();
}

}  // namespace

Matrix6d JackknifeCovariance(const std::vector<Vector6d>& d) {
  Require(d.size() >= 2, "at least two blocks");
  const auto m = static_cast<double>(d.size());
  Vector6d mean = Vector6d::Zero();
  for (const Vector6d& d_i : d) mean += d_i / m;
  Matrix6d scatter = Matrix6d::Zero();
  for (const Vector6d& d_i : d) scatter += (d_i - mean) * (d_i - mean).transpose();
  return (m - 1) / m * scatter;
}

ShrunkCovariance ShrinkTowardsModel(const Matrix6d& C_jack, const Matrix6d& C_model, int m) {
  const Eigen::VectorXd eigenvalues = RelativeEigenvalues(C_jack, C_model);
  const bool told = m > kModelWeightMin + 1.0 && eigenvalues.size() > 0 && ((m - 1.0) * eigenvalues).allFinite();
  const double f = told ? std::max(1.0, eigenvalues.mean()) : 1.0;
  const double ratio = PosteriorRatio(eigenvalues / f, m);
  return {ratio * C_jack + (1.0 - ratio) * f * C_model, ratio};
}

double JackknifeRatioMax(int m) {
  Require(m >= 1, "at least one block");
  return (m - 1.0) / (m - 1.0 + kModelWeightMin);
}

}  // namespace rigcal
