#include "server/model/plausible.h"

#include <cmath>
#include <cstdio>
#include <string>

namespace rigcal {
namespace {

std::string NumberText(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.3g", value);
  return text;
}

}  // namespace

Status CheckPlausible(const Eigen::Vector3d& p_m) {
  const double largest_m = p_m.cwiseAbs().maxCoeff();
  if (largest_m <= kPositionMax_m) return {};
  return Fail(ErrorCode::kInvalidInput,
              "p_m holds " + NumberText(largest_m) + " m, more than the limit of " + NumberText(kPositionMax_m) + " m",
              "Give the position in metres.");
}

Status CheckGivenPose(const Se3& T) {
  constexpr double kUnitTolerance = 1e-6;
  if (!T.p_m.allFinite())
    return Fail(ErrorCode::kInvalidInput, "p_m is not finite", "Give 3 finite numbers in metres.");
  if (!(std::abs(T.q.norm() - 1.0) <= kUnitTolerance))
    return Fail(ErrorCode::kInvalidInput, "q_xyzw is not a unit quaternion", "Normalise it; the order is x y z w.");
  return CheckPlausible(T.p_m);
}

Status CheckPlausible(const Matrix6d& Omega) {
  const double largest = Omega.cwiseAbs().maxCoeff();
  if (largest <= kInformationMax) return {};
  return Fail(ErrorCode::kInvalidInput,
              "information holds " + NumberText(largest) + ", more than the limit of " + NumberText(kInformationMax),
              "Give the inverse of a covariance in m and rad; a sigma below 1 nm or 1 nrad is not believed.");
}

}  // namespace rigcal
