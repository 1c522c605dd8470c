// Numbers that an instrument errs by, drawn for it alone from N(0, sigma^2 I), of a variance that the session tells.
#pragma once

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>

namespace rigcal::calib::joint {

// Estimated freely: b and its covariance, in the unit of b.
struct RandomEffect {
  Eigen::VectorXd b;
  Eigen::MatrixXd C;

  [[nodiscard]] double SquaredSigmas() const { return b.dot(C.ldlt().solve(b)); }
  // The likeliest sigma^2 of N(b; 0, sigma^2 I + C) (restricted maximum likelihood of one effect), by Fisher scoring.
  // `any`: the sigma that held b as good as not at all; none of an effect of which the session tells nothing: that
  // moves no pose.
  [[nodiscard]] double LikeliestVariance(double any) const {
    constexpr int kSteps = 30;
    const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> axes(C);
    if (axes.eigenvalues().minCoeff() > 0.5 * any * any) return 0.0;
    const Eigen::ArrayXd noise = axes.eigenvalues().array();
    const Eigen::ArrayXd excess = (axes.eigenvectors().transpose() * b).array().square() - noise;
    double variance = std::max(0.0, excess.mean());
    for (int step = 0; step < kSteps; ++step) {
      const Eigen::ArrayXd weights = (noise + variance).square().inverse();
      variance = std::max(0.0, (weights * excess).sum() / weights.sum());
    }
    return variance;
  }
};

}  // namespace rigcal::calib::joint
