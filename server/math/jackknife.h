// Delete-one-block jackknife on SE(3) (paper, section III-D, with the missing square restored).
#pragma once

#include <vector>

#include "server/math/se3.h"

namespace rigcal {

// C_jack = (m-1)/m sum (d_i - mean)(d_i - mean)^T, d_i = Log(T^-1 T_(i)). Needs m >= 2 block vectors.
[[nodiscard]] Matrix6d JackknifeCovariance(const std::vector<Vector6d>& d);

// C = jackknife_ratio C_jack + (1 - jackknife_ratio) f C_model.
struct ShrunkCovariance {
  Matrix6d C = Matrix6d::Zero();
  double jackknife_ratio = 0.0;
};
// jackknife_ratio = (m-1) / (m-1 + kappa): the model counts like kappa further blocks, from 7 up to the m - 1 that were
// measured. The blocks tell kappa by how far they scatter from the model (empirical Bayes: Chen 1979; Hannart & Naveau
// 2014): C is the posterior mean where Sigma is inverse Wishart around f C_model with kappa + p + 1 degrees of freedom,
// kappa itself averaged over its posterior, a priori even in its logarithm. f = max(1, tr(C_model^-1 C_jack) / p): how
// much too sure a model is in all is known far better than where. One that tells half of sigma in one direction of six
// takes 11 % from it with 40 blocks; one that tells a fifth of it adds 30 % to the other five. Up to 8 blocks kappa is
// 7 and f is 1: the jackknife of so few errs upwards. Invariant under a change of frame; where C_model is singular, p
// is its rank, and C_jack must lie along it. m >= 1 blocks.
[[nodiscard]] ShrunkCovariance ShrinkTowardsModel(const Matrix6d& C_jack, const Matrix6d& C_model, int m);
// (m-1) / (m+6): with kappa = 7, the most that blocks can make.
[[nodiscard]] double JackknifeRatioMax(int m);

}  // namespace rigcal
