#include "server/math/jackknife.h"

#include <cstdio>
#include <cstdlib>

namespace rigcal {
namespace {

// Our own caller decides how many blocks there are: fewer is a broken invariant.
void Require(bool ok, const char* what) {
  if (ok) return;
  std::fprintf(stderr, "rigcal: jackknife needs %s\n", what);
  std::abort();
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

Matrix6d ShrinkTowardsModel(const Matrix6d& C_jack, const Matrix6d& C_model, int m) {
  const double share = JackknifeShare(m);
  return share * C_jack + (1.0 - share) * C_model;
}

double JackknifeShare(int m) {
  Require(m >= 1, "at least one block");
  return (m - 1.0) / (m + 6.0);
}

}  // namespace rigcal
