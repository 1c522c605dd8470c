#include "server/cloud/facing.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

namespace rigcal::cloud {
namespace {

constexpr float kBundleMin_rad = 0.05F, kBundleMax_rad = 0.14F;
constexpr float kBundleSteps = 5;
constexpr int kPointsMin = 6;
// Of the middle variance: above, the bundle is no plane; a line has no middle variance.
constexpr double kThicknessMax = 0.15, kWidthMin = 0.004;

struct Bundle {
  int count = 0;
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  Eigen::Matrix3d squares = Eigen::Matrix3d::Zero();
};

struct Raster {
  int columns, rows;
  float size_rad;

  [[nodiscard]] std::size_t IndexOf(const Eigen::Vector3f& point) const {
    const float azimuth = std::atan2(point.y(), point.x()) + static_cast<float>(M_PI);
    const float elevation = std::atan2(point.z(), point.head<2>().norm()) + static_cast<float>(M_PI_2);
    const int column = std::clamp(static_cast<int>(azimuth / size_rad), 0, columns - 1);
    const int row = std::clamp(static_cast<int>(elevation / size_rad), 0, rows - 1);
    return static_cast<std::size_t>(row * columns + column);
  }
};

Eigen::Vector3f NormalOf(const Bundle& bundle) {
  if (bundle.count < kPointsMin) return Eigen::Vector3f::Zero();
  const Eigen::Vector3d mean = bundle.sum / bundle.count;
  const Eigen::Matrix3d covariance = bundle.squares / bundle.count - mean * mean.transpose();
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(covariance);
  const Eigen::Vector3d& variances = solver.eigenvalues();
  if (!(variances(1) > kWidthMin * variances(2))) return Eigen::Vector3f::Zero();
  if (!(variances(0) < kThicknessMax * variances(1))) return -mean.normalized().cast<float>();
  const Eigen::Vector3d normal = solver.eigenvectors().col(0);
  return (normal.dot(mean) > 0 ? Eigen::Vector3d(-normal) : normal).cast<float>();
}

}  // namespace

std::vector<Eigen::Vector3f> FacingOf(const std::vector<Eigen::Vector3f>& points_m, float step_rad) {
  const float size_rad = std::clamp(kBundleSteps * step_rad, kBundleMin_rad, kBundleMax_rad);
  const Raster raster{static_cast<int>(2 * M_PI / size_rad) + 1, static_cast<int>(M_PI / size_rad) + 1, size_rad};
  std::vector<Bundle> bundles(static_cast<std::size_t>(raster.columns * raster.rows));
  std::vector<std::uint32_t> own(points_m.size());
  for (std::size_t i = 0; i < points_m.size(); ++i) {
    own[i] = static_cast<std::uint32_t>(raster.IndexOf(points_m[i]));
    Bundle& bundle = bundles[own[i]];
    const Eigen::Vector3d point = points_m[i].cast<double>();
    ++bundle.count, bundle.sum += point, bundle.squares += point * point.transpose();
  }
  std::vector<Eigen::Vector3f> normals(bundles.size()), facing(points_m.size());
  for (std::size_t b = 0; b < bundles.size(); ++b) normals[b] = NormalOf(bundles[b]);
  for (std::size_t i = 0; i < points_m.size(); ++i) facing[i] = normals[own[i]];
  return facing;
}

}  // namespace rigcal::cloud
