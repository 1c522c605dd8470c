#include "server/calib/camera/rational_start.h"

#include <Eigen/Cholesky>
#include <cmath>

namespace rigcal::calib {
namespace {

constexpr double kReachMax_rad = 80 * M_PI / 180;
constexpr int kSamples = 100;
constexpr int kTerms = 6;  // k1 k2 k3, then k4 k5 k6
// Of the equations' mean diagonal: the two halves nearly cancel, and of all that bend alike the smallest will do.
constexpr double kDamping = 1e-9;
constexpr double kOffMax_ratio = 0.01;  // of the focal length: a start may be off by so much

// Where the fisheye has a ray, in focal lengths from the principal point.
double Bent(const IntrinsicsVector& fisheye, double angle_rad) {
  const double s = angle_rad * angle_rad;
  return angle_rad * (1 + s * (fisheye[4] + s * (fisheye[5] + s * (fisheye[6] + s * fisheye[7]))));
}

struct Equations {
  Eigen::Matrix<double, kSamples, kTerms> by_terms;
  Eigen::Matrix<double, kSamples, 1> wanted;
};

// q (1 + k4 s + k5 s^2 + k6 s^3) = 1 + k1 s + k2 s^2 + k3 s^3 with q the fisheye's radius over the undistorted one,
// times the latter, at angles up to the reach; s in units of its largest value.
Equations EquationsOf(const IntrinsicsVector& fisheye, double reach_rad) {
  Equations equations;
  for (int i = 0; i < kSamples; ++i) {
    const double angle_rad = reach_rad * (i + 1) / kSamples, r = std::tan(angle_rad);
    const double quotient = Bent(fisheye, angle_rad) / r, s = std::pow(r / std::tan(reach_rad), 2);
    const Eigen::RowVector3d powers(s, s * s, s * s * s);
    equations.by_terms.row(i) << r * powers, -r * quotient * powers;
    equations.wanted[i] = r * (quotient - 1);
  }
  return equations;
}

}  // namespace

std::optional<IntrinsicsVector> RationalLike(const IntrinsicsVector& fisheye, double reach_rad) {
  if (!(reach_rad > 0 && reach_rad < kReachMax_rad)) return std::nullopt;
  const Equations equations = EquationsOf(fisheye, reach_rad);
  Eigen::Matrix<double, kTerms, kTerms> normal = equations.by_terms.transpose() * equations.by_terms;
  normal.diagonal().array() += kDamping * normal.trace() / kTerms;
  const Eigen::Matrix<double, kTerms, 1> k = normal.ldlt().solve(equations.by_terms.transpose() * equations.wanted);
  const double s = std::pow(std::tan(reach_rad), 2);
  IntrinsicsVector rational = IntrinsicsVector::Zero();
  rational.head<4>() = fisheye.head<4>();
  rational.tail<8>() << k[0] / s, k[1] / (s * s), 0, 0, k[2] / (s * s * s), k[3] / s, k[4] / (s * s),
      k[5] / (s * s * s);
  for (const double part : {0.25, 0.5, 0.75, 1.0}) {
    const double angle_rad = part * reach_rad;
    const Projection at =
        Project(CameraModel::kPinholeRational, rational, {std::sin(angle_rad), 0, std::cos(angle_rad)});
    const double off_px = at.uv_px.x() - rational[2] - rational[0] * Bent(fisheye, angle_rad);
    if (!at.in_front || !(std::abs(off_px) < kOffMax_ratio * rational[0])) return std::nullopt;
  }
  return rational;
}

}  // namespace rigcal::calib
