#include "server/calib/camera/projection.h"

#include <Eigen/LU>
#include <array>
#include <cmath>

#include "server/calib/camera/sphere_models.h"

namespace rigcal::calib {
namespace {

constexpr int kCountMax = 9;
constexpr int kDepthMax = 24;

using Bernstein = std::array<double, kCountMax>;

double Binomial(int n, int k) {
  double value = 1;
  for (int i = 0; i < k; ++i) value = value * (n - i) / (i + 1);
  return value;
}

Bernstein OnUnitInterval(const double* coefficients, int count, double s_max) {
  Bernstein control{};
  double power = 1;
  for (int i = 0; i < count; ++i, power *= s_max)
    for (int j = i; j < count; ++j)
      control[static_cast<std::size_t>(j)] += Binomial(j, i) / Binomial(count - 1, i) * coefficients[i] * power;
  return control;
}

// Halves the interval (de Casteljau): `control` becomes the left half, the right half is returned.
Bernstein SplitOff(Bernstein& control, std::size_t count) {
  Bernstein right{};
  Bernstein level = control;
  for (std::size_t step = 0; step < count; ++step) {
    control[step] = level[0];
    right[count - 1 - step] = level[count - 1 - step];
    for (std::size_t i = 0; i + 1 + step < count; ++i) level[i] = 0.5 * (level[i] + level[i + 1]);
  }
  return right;
}

bool Positive(Bernstein control, std::size_t count, int depth) {
  if (!(control[0] > 0 && control[count - 1] > 0)) return false;
  const auto end = control.begin() + static_cast<std::ptrdiff_t>(count);
  if (std::all_of(control.begin(), end, [](double value) { return value > 0; })) return true;
  if (depth == kDepthMax) return false;
  const Bernstein right = SplitOff(control, count);
  return Positive(control, count, depth + 1) && Positive(right, count, depth + 1);
}

// Nearer than this a point is on the lens: its projection says nothing.
constexpr double kNearestDepth_m = 1e-6;

constexpr int kFirst = 4;  // of the distortion

// The factor on x and y that both pinhole models apply, of s = x^2 + y^2.
struct Radial {
  bool folded;
  double value;
  double slope;               // by s
  double above[3], below[3];  // derivatives of the value by k1 k2 k3, and by k4 k5 k6
};

// x (1 + k1 s + k2 s^2 + k3 s^3) grows along the radius while 1 + 3 k1 s + 5 k2 s^2 + 7 k3 s^3 > 0.
inline Radial PolynomialRadial(const IntrinsicsVector& intrinsics, double s) {
  const double k1 = intrinsics[kFirst], k2 = intrinsics[kFirst + 1], k3 = intrinsics[kFirst + 4];
  const double s2 = s * s, s3 = s2 * s;
  const bool folded = !PositiveUpTo<4>({1, 3 * k1, 5 * k2, 7 * k3}, s);
  return {folded, 1 + k1 * s + k2 * s2 + k3 * s3, k1 + 2 * k2 * s + 3 * k3 * s2, {s, s2, s3}, {0, 0, 0}};
}

// The slope of x N(s) / D(s) along the radius, times D^2: N D + 2 s (N' D - N D').
Eigen::Matrix<double, 7, 1> SlopeOfQuotient(const Eigen::Vector4d& above, const Eigen::Vector4d& below) {
  Eigen::Matrix<double, 7, 1> slope = Eigen::Matrix<double, 7, 1>::Zero();
  for (int i = 0; i < 4; ++i)
    for (int j = 0; j < 4; ++j) slope[i + j] += above[i] * below[j] * (1 + 2 * (i - j));
  return slope;
}

Radial RationalRadial(const IntrinsicsVector& intrinsics, double s) {
  const Eigen::Vector4d above(1, intrinsics[kFirst], intrinsics[kFirst + 1], intrinsics[kFirst + 4]);
  const Eigen::Vector4d below(1, intrinsics[kFirst + 5], intrinsics[kFirst + 6], intrinsics[kFirst + 7]);
  const Eigen::Vector4d powers(1, s, s * s, s * s * s), slopes(0, 1, 2 * s, 3 * s * s);
  const bool folded = !PositiveUpTo<4>(below, s) || !PositiveUpTo<7>(SlopeOfQuotient(above, below), s);
  const double inverse = 1 / below.dot(powers), value = above.dot(powers) * inverse;
  const double slope = (above.dot(slopes) - value * below.dot(slopes)) * inverse;
  const Eigen::Vector3d by_above = inverse * powers.tail<3>(), by_below = -value * by_above;
  return {folded, value, slope, {by_above[0], by_above[1], by_above[2]}, {by_below[0], by_below[1], by_below[2]}};
}

template <bool kRational>
Projection ProjectPinhole(const IntrinsicsVector& intrinsics, const Eigen::Vector3d& p_cam, bool with_derivatives) {
  Projection result;
  if (!(p_cam.z() > kNearestDepth_m)) return result;
  const double inverse_z = 1 / p_cam.z(), x = p_cam.x() * inverse_z, y = p_cam.y() * inverse_z, s = x * x + y * y;
  const Radial radial = kRational ? RationalRadial(intrinsics, s) : PolynomialRadial(intrinsics, s);
  if (radial.folded) return result;
  result.in_front = true;
  const double fx = intrinsics[0], fy = intrinsics[1], p1 = intrinsics[kFirst + 2], p2 = intrinsics[kFirst + 3];
  const double x_d = x * radial.value + 2 * p1 * x * y + p2 * (s + 2 * x * x);
  const double y_d = y * radial.value + p1 * (s + 2 * y * y) + 2 * p2 * x * y;
  result.uv_px << fx * x_d + intrinsics[2], fy * y_d + intrinsics[3];
  if (!with_derivatives) return result;

  const double mixed = 2 * x * y * radial.slope + 2 * p1 * x + 2 * p2 * y;
  Eigen::Matrix2d d_xy;
  d_xy << radial.value + 2 * x * x * radial.slope + 2 * p1 * y + 6 * p2 * x, mixed,  //
      mixed, radial.value + 2 * y * y * radial.slope + 6 * p1 * y + 2 * p2 * x;
  Eigen::Matrix<double, 2, 3> d_normalized;
  d_normalized << inverse_z, 0, -x * inverse_z, 0, inverse_z, -y * inverse_z;
  result.d_point = Eigen::Vector2d(fx, fy).asDiagonal() * d_xy * d_normalized;

  const double(&above)[3] = radial.above, (&below)[3] = radial.below;
  const double X = fx * x, Y = fy * y;
  result.d_intrinsics << x_d, 0, 1, 0, X * above[0], X * above[1], fx * 2 * x * y, fx * (s + 2 * x * x), X * above[2],
      X * below[0], X * below[1], X * below[2],  //
      0, y_d, 0, 1, Y * above[0], Y * above[1], fy * (s + 2 * y * y), fy * 2 * x * y, Y * above[2], Y * below[0],
      Y * below[1], Y * below[2];
  return result;
}

// u = fx theta_d(theta) x / r + cx with r = |(x, y)|, theta = atan2(r, z).
Projection ProjectFisheye(const IntrinsicsVector& intrinsics, const Eigen::Vector3d& p_cam, bool with_derivatives) {
  Projection result;
  const double r = p_cam.head<2>().norm(), range2 = p_cam.squaredNorm();
  // On the axis only ahead: behind, the image of the point is a circle.
  const bool away = range2 > kNearestDepth_m * kNearestDepth_m && std::isfinite(range2);
  if (!away || !(r > 0 || p_cam.z() > 0)) return result;
  const double theta = std::atan2(r, p_cam.z()), s = theta * theta;
  const Eigen::Vector4d k = intrinsics.segment<4>(kFirst), powers(s, s * s, s * s * s, s * s * s * s);
  const Eigen::Vector4d odd(3, 5, 7, 9);
  if (!PositiveUpTo<5>({1, 3 * k[0], 5 * k[1], 7 * k[2], 9 * k[3]}, s)) return result;
  result.in_front = true;
  const Eigen::Vector2d focal = intrinsics.head<2>();
  const double theta_d = theta * (1 + k.dot(powers)), slope = 1 + k.cwiseProduct(odd).dot(powers);
  const Eigen::Vector2d direction = r > 0 ? Eigen::Vector2d(p_cam.head<2>() / r) : Eigen::Vector2d::Zero();
  const Eigen::Vector2d image = theta_d * direction;
  result.uv_px = focal.cwiseProduct(image) + intrinsics.segment<2>(2);
  if (!with_derivatives) return result;

  const double sideways = r > 0 ? theta_d / r : 1 / p_cam.z();    // across the radius
  const double outwards = slope * p_cam.z() / range2 - sideways;  // along it, beyond that
  PointJacobian d_image;
  d_image.leftCols<2>() = sideways * Eigen::Matrix2d::Identity() + outwards * direction * direction.transpose();
  d_image.col(2) = -slope * r / range2 * direction;
  result.d_point = focal.asDiagonal() * d_image;
  result.d_intrinsics.leftCols<2>() = image.asDiagonal();
  result.d_intrinsics.middleCols<2>(2).setIdentity();
  result.d_intrinsics.middleCols<4>(kFirst) = theta * focal.cwiseProduct(direction) * powers.transpose();
  return result;
}

constexpr int kStepsMax = 60, kStepHalvingsMax = 40;
constexpr double kSolved_px = 1e-8;
// Below this the last step changed nothing but rounding.
constexpr double kUndistorted_px = 1e-11;

// Of a sphere model the ray of the pixel, not finite where there is none; of others where an undistorted lens has it.
Eigen::Vector3d FirstRay(CameraModel model, const IntrinsicsVector& intrinsics, const Eigen::Vector2d& uv_px) {
  const Eigen::Vector2d xy = (uv_px - intrinsics.segment<2>(2)).cwiseQuotient(intrinsics.head<2>());
  if (IsSphere(model)) return SphereRay(model, intrinsics, xy);
  if (model != CameraModel::kFisheyeKb4) return Eigen::Vector3d(xy.x(), xy.y(), 1).normalized();
  const double theta = xy.norm();
  if (!(theta > 0)) return Eigen::Vector3d::UnitZ();
  const double bounded = std::min(theta, 0.9 * M_PI);
  return {std::sin(bounded) * xy.x() / theta, std::sin(bounded) * xy.y() / theta, std::cos(bounded)};
}

// Two unit vectors across the ray.
Eigen::Matrix<double, 3, 2> Across(const Eigen::Vector3d& ray) {
  Eigen::Matrix<double, 3, 2> basis;
  basis.col(0) = ray.unitOrthogonal();
  basis.col(1) = ray.cross(basis.col(0));
  return basis;
}

struct Guess {
  Eigen::Vector3d ray;
  Projection projection;
  double error_px = 0;
};

Guess GuessAt(CameraModel model, const IntrinsicsVector& intrinsics, const Eigen::Vector3d& ray,
              const Eigen::Vector2d& uv_px) {
  Guess guess{ray.normalized(), {}, 0};
  guess.projection = Project(model, intrinsics, guess.ray);
  guess.error_px = (guess.projection.uv_px - uv_px).norm();
  return guess;
}

}  // namespace

bool PositiveBySubdivision(const double* coefficients, int count, double s_max) {
  return Positive(OnUnitInterval(coefficients, count, s_max), static_cast<std::size_t>(count), 0);
}

IntrinsicsVector VectorOf(const CameraIntrinsics& intrinsics) {
  IntrinsicsVector vector = IntrinsicsVector::Zero();
  vector.head<4>() << intrinsics.fx_px, intrinsics.fy_px, intrinsics.cx_px, intrinsics.cy_px;
  const std::size_t count = std::min(DistortionCount(intrinsics.model), intrinsics.distortion.size());
  for (std::size_t i = 0; i < count; ++i) vector[kFirst + static_cast<Eigen::Index>(i)] = intrinsics.distortion[i];
  return vector;
}

IntrinsicsVector PaddedIntrinsics(CameraModel model, const double* values) {
  IntrinsicsVector vector = IntrinsicsVector::Zero();
  std::copy_n(values, IntrinsicsCount(model), vector.data());
  return vector;
}

CameraIntrinsics IntrinsicsOf(CameraModel model, const IntrinsicsVector& vector) {
  const double* distortion = vector.data() + kFirst;
  return {vector[0], vector[1], vector[2], vector[3], {distortion, distortion + DistortionCount(model)}, model};
}

Projection Project(CameraModel model, const IntrinsicsVector& intrinsics, const Eigen::Vector3d& p_cam,
                   bool with_derivatives) {
  if (model == CameraModel::kFisheyeKb4) return ProjectFisheye(intrinsics, p_cam, with_derivatives);
  if (model == CameraModel::kPinholeRational) return ProjectPinhole<true>(intrinsics, p_cam, with_derivatives);
  if (IsSphere(model)) return ProjectSphere(model, intrinsics, p_cam, with_derivatives);
  return ProjectPinhole<false>(intrinsics, p_cam, with_derivatives);
}

std::optional<Eigen::Vector3d> Unproject(CameraModel model, const IntrinsicsVector& intrinsics,
                                         const Eigen::Vector2d& uv_px) {
  if (!uv_px.allFinite() || !intrinsics.allFinite()) return std::nullopt;
  Eigen::Vector3d ray = FirstRay(model, intrinsics, uv_px);
  if (IsSphere(model) && !ray.allFinite()) return std::nullopt;
  Guess guess = GuessAt(model, intrinsics, ray, uv_px);
  // Towards the axis until it is seen.
  for (int i = 0; i < kStepHalvingsMax && !guess.projection.in_front; ++i) {
    ray = ray.normalized() + 0.3 * Eigen::Vector3d::UnitZ();
    guess = GuessAt(model, intrinsics, ray, uv_px);
  }
  if (!guess.projection.in_front) return std::nullopt;
  for (int i = 0; i < kStepsMax && guess.error_px > kUndistorted_px; ++i) {
    const Eigen::Matrix<double, 3, 2> across = Across(guess.ray);
    const Eigen::Matrix2d slope = guess.projection.d_point * across;
    Eigen::Vector2d step = slope.fullPivLu().solve(uv_px - guess.projection.uv_px);
    step *= std::min(1.0, 0.5 / step.norm());
    Guess next = guess;
    for (int halving = 0; halving < kStepHalvingsMax; ++halving, step *= 0.5) {
      next = GuessAt(model, intrinsics, guess.ray + across * step, uv_px);
      if (next.projection.in_front && next.error_px < guess.error_px) break;
    }
    if (!(next.projection.in_front && next.error_px < guess.error_px)) break;
    guess = next;
  }
  if (!(guess.error_px < kSolved_px)) return std::nullopt;
  return guess.ray;
}

}  // namespace rigcal::calib
