// Oracle: the spread of many perturbed transforms. An entry of a sample covariance of n has the standard error
// sqrt((C_ii C_jj + C_ij^2) / n); 6 of them pass 36 entries with odds of a false alarm below 1e-7 (the seeds are
// fixed).
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <random>

#include "server/math/covariance.h"

namespace rigcal {
namespace {

constexpr int kSamples = 40'000;
constexpr double kStandardErrors = 6.0;
using Vector12d = Eigen::Matrix<double, 12, 1>;
using Matrix12d = Eigen::Matrix<double, 12, 12>;

Se3 Pose(double x, double y, double z, double rx, double ry, double rz) {
  Vector6d xi;
  xi << x, y, z, rx, ry, rz;
  return Se3::Exp(xi);
}

// A correlated factor L of a covariance L L^T: about 1 mm and 1 mrad, so that what is of second order stays below 1e-6
// of what is tested.
Matrix12d RandomFactor(unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  Matrix12d L;
  for (double& value : L.reshaped()) value = 5e-4 * uniform(random);
  return L;
}

Matrix6d SampleCovariance(const Matrix12d& L, const std::function<Vector6d(const Vector6d&, const Vector6d&)>& error) {
  std::mt19937 random(77);
  std::normal_distribution<double> normal;
  Matrix6d sum = Matrix6d::Zero();
  Vector6d mean = Vector6d::Zero();
  for (int i = 0; i < kSamples; ++i) {
    Vector12d z;
    for (double& value : z) value = normal(random);
    const Vector12d xi = L * z;
    const Vector6d e = error(xi.head<6>(), xi.tail<6>());
    sum += e * e.transpose() / kSamples;
    mean += e / kSamples;
  }
  return sum - mean * mean.transpose();
}

void ExpectWithinSamplingError(const Matrix6d& sampled, const Matrix6d& C) {
  for (int i = 0; i < 6; ++i)
    for (int j = 0; j < 6; ++j) {
      const double standard_error = std::sqrt((C(i, i) * C(j, j) + C(i, j) * C(i, j)) / kSamples);
      EXPECT_NEAR(sampled(i, j), C(i, j), kStandardErrors * standard_error) << i << " " << j;
    }
}

TEST(MonteCarlo, Inverse) {
  const Se3 T_a_b = Pose(0.6, -1.2, 2.0, 0.9, -0.4, 1.3);
  const Matrix12d L = RandomFactor(11);
  const Matrix6d C_ab = (L * L.transpose()).topLeftCorner<6, 6>();
  const Se3 T_b_a = T_a_b.Inverse();
  const Matrix6d sampled = SampleCovariance(L, [&](const Vector6d& xi, const Vector6d&) {
    return (T_b_a.Inverse() * (T_a_b * Se3::Exp(xi)).Inverse()).Log();
  });
  ExpectWithinSamplingError(sampled, InverseCovariance(T_a_b, C_ab));
}

TEST(MonteCarlo, ComposeOfIndependentErrors) {
  const Se3 T_a_b = Pose(0.6, -1.2, 2.0, 0.9, -0.4, 1.3), T_b_c = Pose(-1.5, 0.2, 0.7, -0.3, 1.8, 0.5);
  Matrix12d L = RandomFactor(12);
  L.topRightCorner<6, 6>().setZero();
  L.bottomLeftCorner<6, 6>().setZero();
  const Matrix12d C = L * L.transpose();
  const Matrix6d sampled = SampleCovariance(L, [&](const Vector6d& xi_ab, const Vector6d& xi_bc) {
    const Se3 T_a_c = T_a_b * Se3::Exp(xi_ab) * T_b_c * Se3::Exp(xi_bc);
    return ((T_a_b * T_b_c).Inverse() * T_a_c).Log();
  });
  ExpectWithinSamplingError(sampled, ComposeCovariance(C.topLeftCorner<6, 6>(), T_b_c, C.bottomRightCorner<6, 6>()));
}

TEST(MonteCarlo, RelativeOfCorrelatedPoses) {
  const Se3 T_ref_A = Pose(0.6, -1.2, 2.0, 0.9, -0.4, 1.3), T_ref_B = Pose(-1.5, 0.2, 0.7, -0.3, 1.8, 0.5);
  const Se3 T_A_B = T_ref_A.Inverse() * T_ref_B;
  const Matrix12d L = RandomFactor(13);
  const Matrix12d C = L * L.transpose();
  const Matrix6d sampled = SampleCovariance(L, [&](const Vector6d& xi_A, const Vector6d& xi_B) {
    const Se3 perturbed = (T_ref_A * Se3::Exp(xi_A)).Inverse() * (T_ref_B * Se3::Exp(xi_B));
    return (T_A_B.Inverse() * perturbed).Log();
  });
  const Matrix6d C_AA = C.topLeftCorner<6, 6>(), C_BB = C.bottomRightCorner<6, 6>(), C_AB = C.topRightCorner<6, 6>();
  ExpectWithinSamplingError(sampled, RelativeCovariance(T_A_B, C_AA, C_BB, C_AB));
  // The correlation matters here: without it the same bounds do not hold.
  const Matrix6d ignored = RelativeCovariance(T_A_B, C_AA, C_BB, Matrix6d::Zero());
  EXPECT_GT((sampled - ignored).norm(), 0.1 * sampled.norm());
}

}  // namespace
}  // namespace rigcal
