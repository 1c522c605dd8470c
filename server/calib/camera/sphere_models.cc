#include "server/calib/camera/sphere_models.h"

#include <cmath>

namespace rigcal::calib {
namespace {

constexpr int kFirstShape = 4;              // of the distortion
constexpr double kNearestDivisor_m = 1e-6;  // as of a pinhole's depth

// What divides x and y in both sphere models, alpha d2 + (1 - alpha) k, and its derivatives.
struct Divisor {
  bool folded = true;
  double value = 0;
  Eigen::RowVector3d by_point = Eigen::RowVector3d::Zero();
  Eigen::RowVector2d by_distortion = Eigen::RowVector2d::Zero();
};

// With c = k / d2 the image is sqrt(1 - c^2) / (alpha + (1 - alpha) c), but for a factor that is constant: finite while
// the denominator is positive, and growing away from the axis while alpha c + 1 - alpha is (c falls all the way). Both
// hold from the axis outwards up to some angle and never again beyond, for any alpha. For alpha in [0, 1] that is
// c > -w1 of Usenko et al. (2018), w1 = min(alpha, 1 - alpha) / max(alpha, 1 - alpha).
bool Folded(double alpha, double value, double k, double d2) {
  return !(value > kNearestDivisor_m && std::isfinite(value) && (1 - alpha) * d2 + alpha * k > 0);
}

Divisor EucmDivisor(const IntrinsicsVector& intrinsics, const Eigen::Vector3d& p_cam) {
  const double alpha = intrinsics[kFirstShape], beta = intrinsics[kFirstShape + 1], r2 = p_cam.head<2>().squaredNorm();
  const double z = p_cam.z(), d2 = std::sqrt(beta * r2 + z * z);
  Divisor divisor;
  divisor.value = alpha * d2 + (1 - alpha) * z;
  divisor.folded = !(beta > 0) || Folded(alpha, divisor.value, z, d2);
  divisor.by_point << alpha * beta * p_cam.x() / d2, alpha * beta * p_cam.y() / d2, alpha * z / d2 + 1 - alpha;
  divisor.by_distortion << d2 - z, 0.5 * alpha * r2 / d2;
  return divisor;
}

// The paper's own limit, z > -w2 |p|, leaves away a degree or so of what c > -w1 allows, and for xi far below 0 takes
// in points that no image has. c falls with the angle from the axis while |p| + xi z > 0, which xi in (-1, 1) always
// has.
Divisor DoubleSphereDivisor(const IntrinsicsVector& intrinsics, const Eigen::Vector3d& p_cam) {
  const double xi = intrinsics[kFirstShape], alpha = intrinsics[kFirstShape + 1], d1 = p_cam.norm(),
               k = xi * d1 + p_cam.z();
  const double d2 = std::hypot(p_cam.head<2>().norm(), k);
  Divisor divisor;
  divisor.value = alpha * d2 + (1 - alpha) * k;
  divisor.folded = !(xi > -1 && d1 + xi * p_cam.z() > 0) || Folded(alpha, divisor.value, k, d2);
  const Eigen::RowVector3d k_by_point = xi / d1 * p_cam.transpose() + Eigen::RowVector3d::UnitZ();
  const Eigen::RowVector3d across(p_cam.x(), p_cam.y(), 0);
  divisor.by_point = alpha / d2 * (across + k * k_by_point) + (1 - alpha) * k_by_point;
  divisor.by_distortion << (alpha * k / d2 + 1 - alpha) * d1, d2 - k;
  return divisor;
}

}  // namespace

Projection ProjectSphere(CameraModel model, const IntrinsicsVector& intrinsics, const Eigen::Vector3d& p_cam,
                         bool with_derivatives) {
  Projection result;
  const Divisor divisor = model == CameraModel::kEucm ? EucmDivisor(intrinsics, p_cam)  //
                                                      : DoubleSphereDivisor(intrinsics, p_cam);
  if (divisor.folded) return result;
  result.in_front = true;
  const Eigen::Vector2d focal = intrinsics.head<2>(), image = p_cam.head<2>() / divisor.value;
  result.uv_px = focal.cwiseProduct(image) + intrinsics.segment<2>(2);
  if (!with_derivatives) return result;

  const Eigen::Vector2d slope = -focal.cwiseProduct(image) / divisor.value;
  result.d_point = slope * divisor.by_point;
  result.d_point.leftCols<2>().diagonal() += focal / divisor.value;
  result.d_intrinsics.leftCols<2>() = image.asDiagonal();
  result.d_intrinsics.middleCols<2>(2).setIdentity();
  result.d_intrinsics.middleCols<2>(kFirstShape) = slope * divisor.by_distortion;
  return result;
}

namespace {

// With the divisor as the unit of length; not finite where no ray leads to the pixel.
Eigen::Vector3d EucmRay(double alpha, double beta, const Eigen::Vector2d& xy) {
  const double s = beta * xy.squaredNorm();
  const double z = (1 - alpha * alpha * s) / (alpha * std::sqrt(1 - (2 * alpha - 1) * s) + 1 - alpha);
  return {xy.x(), xy.y(), z};
}

// The same with beta 1 gives the direction (x, y, k); from there back by xi |p| to the first sphere.
Eigen::Vector3d DoubleSphereRay(double xi, double alpha, const Eigen::Vector2d& xy) {
  const Eigen::Vector3d second = EucmRay(alpha, 1.0, xy).normalized();
  const double c = second.z(), length = xi * c + std::sqrt(1 - xi * xi * (1 - c * c));
  return length * second - xi * Eigen::Vector3d::UnitZ();
}

}  // namespace

Eigen::Vector3d SphereRay(CameraModel model, const IntrinsicsVector& intrinsics, const Eigen::Vector2d& xy) {
  const double first = intrinsics[kFirstShape], second = intrinsics[kFirstShape + 1];
  return model == CameraModel::kEucm ? EucmRay(first, second, xy) : DoubleSphereRay(first, second, xy);
}

}  // namespace rigcal::calib
