#include "client/sim/rig/sphere_lens.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <limits>

namespace rigcal::sim {
namespace {

using Complex = std::complex<double>;

template <typename Number>
using Three = std::array<Number, 3>;

// fx fy cx cy and the two of the distortion.
constexpr std::size_t kCount = 6;
template <typename Number>
using Six = std::array<Number, kCount>;

template <typename Number>
Three<Number> OfUnitLength(const Three<Number>& v) {
  const Number length = std::sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
  return {v[0] / length, v[1] / length, v[2] / length};
}

// Onto the plane before a sphere of radius 1, seen from a point alpha / (1 - alpha) behind its centre; scaled by
// 1 - alpha, for which no alpha is singular.
template <typename Number>
std::array<Number, 2> FromSphere(const Three<Number>& on_sphere, const Number& alpha) {
  const Number depth = alpha + (1.0 - alpha) * on_sphere[2];
  return {on_sphere[0] / depth, on_sphere[1] / depth};
}

// The surface that eucm projects to instead is a sphere once x and y are stretched by the root of beta.
template <typename Number>
std::array<Number, 2> EucmImage(const Three<Number>& p, const Number& alpha, const Number& beta) {
  const Number stretch = std::sqrt(beta);
  const std::array<Number, 2> stretched =
      FromSphere(OfUnitLength<Number>({stretch * p[0], stretch * p[1], p[2]}), alpha);
  return {stretched[0] / stretch, stretched[1] / stretch};
}

// Onto the first sphere, then onto a second one whose centre lies xi behind.
template <typename Number>
std::array<Number, 2> DoubleSphereImage(const Three<Number>& p, const Number& xi, const Number& alpha) {
  Three<Number> on_first = OfUnitLength(p);
  on_first[2] += xi;
  return FromSphere(OfUnitLength(on_first), alpha);
}

template <typename Number>
std::array<Number, 2> PixelOf(CameraModel model, const Six<Number>& lens, const Three<Number>& p) {
  const std::array<Number, 2> image = model == CameraModel::kEucm ? EucmImage(p, lens[4], lens[5])  //
                                                                  : DoubleSphereImage(p, lens[4], lens[5]);
  return {lens[0] * image[0] + lens[2], lens[1] * image[1] + lens[3]};
}

Six<double> NumbersOf(const CameraIntrinsics& camera) {
  return {camera.fx_px, camera.fy_px, camera.cx_px, camera.cy_px, camera.distortion[0], camera.distortion[1]};
}

// Im f(x + ih) / h: no difference is taken, so nothing cancels.
Eigen::Matrix<double, 2, 3 + kCount> Derivatives(CameraModel model, const Six<double>& lens, const Eigen::Vector3d& p) {
  constexpr double kStep = 1e-100;
  Eigen::Matrix<double, 2, 3 + kCount> derivatives;
  for (std::size_t column = 0; column < 3 + kCount; ++column) {
    Three<Complex> point{p.x(), p.y(), p.z()};
    Six<Complex> numbers;
    std::copy(lens.begin(), lens.end(), numbers.begin());
    (column < 3 ? point[column] : numbers[column - 3]) += Complex(0, kStep);
    const std::array<Complex, 2> pixel = PixelOf(model, numbers, point);
    derivatives.col(static_cast<Eigen::Index>(column)) << pixel[0].imag() / kStep, pixel[1].imag() / kStep;
  }
  return derivatives;
}

// Where a lens of unit focal length has a ray at this angle from the axis; infinite where no image has it.
double RadiusAt(CameraModel model, const Six<double>& lens, double angle_rad) {
  const Six<double> unit{1, 1, 0, 0, lens[4], lens[5]};
  const double radius = PixelOf<double>(model, unit, {std::sin(angle_rad), 0, std::cos(angle_rad)})[0];
  return radius >= 0 ? radius : std::numeric_limits<double>::infinity();
}

// Up to where the radius grows.
double Border_rad(CameraModel model, const Six<double>& lens) {
  constexpr double kStep_rad = 1e-3;
  double before = 0;
  for (double angle_rad = kStep_rad; angle_rad < M_PI; angle_rad += kStep_rad) {
    const double radius = RadiusAt(model, lens, angle_rad);
    if (!(radius > before && std::isfinite(radius))) return angle_rad - kStep_rad;
    before = radius;
  }
  return M_PI - kStep_rad;
}

// `image` in focal lengths from the principal point.
Eigen::Vector3d RayOf(CameraModel model, const Six<double>& lens, double border_rad, const Eigen::Vector2d& image) {
  constexpr int kHalvings = 52;
  const double radius = image.norm();
  if (radius < 1e-12) return Eigen::Vector3d::UnitZ();
  double low_rad = 0, high_rad = border_rad;
  for (int i = 0; i < kHalvings; ++i) {
    const double middle_rad = 0.5 * (low_rad + high_rad);
    (RadiusAt(model, lens, middle_rad) < radius ? low_rad : high_rad) = middle_rad;
  }
  const Eigen::Vector2d sideways = std::sin(low_rad) / radius * image;
  return {sideways.x(), sideways.y(), std::cos(low_rad)};
}

}  // namespace

std::vector<Eigen::Vector2d> SpherePixelsOf(const CameraIntrinsics& intrinsics,
                                            const std::vector<Eigen::Vector3d>& points_cam) {
  const Six<double> lens = NumbersOf(intrinsics);
  std::vector<Eigen::Vector2d> pixels;
  for (const Eigen::Vector3d& p : points_cam) {
    const std::array<double, 2> pixel = PixelOf<double>(intrinsics.model, lens, {p.x(), p.y(), p.z()});
    pixels.emplace_back(pixel[0], pixel[1]);
  }
  return pixels;
}

std::vector<LensPoint> SpherePixelsWithDerivatives(const CameraIntrinsics& intrinsics,
                                                   const std::vector<Eigen::Vector3d>& points_cam) {
  const Six<double> lens = NumbersOf(intrinsics);
  const std::vector<Eigen::Vector2d> pixels = SpherePixelsOf(intrinsics, points_cam);
  std::vector<LensPoint> points(pixels.size());
  for (std::size_t i = 0; i < points.size(); ++i) {
    const auto derivatives = Derivatives(intrinsics.model, lens, points_cam[i]);
    points[i] = {pixels[i], derivatives.leftCols<3>(), derivatives.rightCols<kCount>()};
  }
  return points;
}

std::vector<Eigen::Vector3d> SphereRaysOf(const CameraIntrinsics& intrinsics,
                                          const std::vector<Eigen::Vector2d>& pixels) {
  const Six<double> lens = NumbersOf(intrinsics);
  const double border_rad = Border_rad(intrinsics.model, lens);
  std::vector<Eigen::Vector3d> rays;
  for (const Eigen::Vector2d& pixel : pixels)
    rays.push_back(
        RayOf(intrinsics.model, lens, border_rad,
              {(pixel.x() - intrinsics.cx_px) / intrinsics.fx_px, (pixel.y() - intrinsics.cy_px) / intrinsics.fy_px}));
  return rays;
}

}  // namespace rigcal::sim
