#include "server/detect/clouds/flat_patch.h"

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

namespace rigcal::detect {
namespace {

constexpr std::size_t kPointsMin = 6;
constexpr double kTukey = 4.685, kSigmaMin_m = 0.002;
constexpr double kToleranceMin_m = 0.025, kToleranceMax_m = 0.12;
constexpr double kGrazing = 0.08;  // cosine of incidence below which a ray says nothing

struct Spread {
  FittedPlane plane;
  double width_m = 0;  // standard deviation across the longest direction, within the plane
};

Spread WeightedFit(const std::vector<Eigen::Vector3d>& points, const std::vector<double>& weights) {
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  double total = 0;
  for (std::size_t i = 0; i < points.size(); ++i) mean += weights[i] * points[i], total += weights[i];
  mean /= total;
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Eigen::Vector3d off = points[i] - mean;
    covariance += weights[i] * off * off.transpose();
  }
  Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> eigen;
  eigen.computeDirect(covariance / total);
  Spread fit;
  fit.plane.normal = eigen.eigenvectors().col(0);
  fit.plane.offset_m = -fit.plane.normal.dot(mean);
  if (fit.plane.offset_m < 0) fit.plane.normal = -fit.plane.normal, fit.plane.offset_m = -fit.plane.offset_m;
  fit.plane.centroid_m = mean;
  fit.width_m = std::sqrt(std::max(0.0, eigen.eigenvalues()[1]));
  return fit;
}

double MedianOf(std::vector<double>& values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

}  // namespace

double FittedPlane::Tolerance_m() const { return std::clamp(3 * sigma_m, kToleranceMin_m, kToleranceMax_m); }

std::optional<FittedPlane> FitPlane(const std::vector<Eigen::Vector3d>& points_m, double width_min_m, int rounds) {
  if (points_m.size() < kPointsMin) return std::nullopt;
  std::vector<double> weights(points_m.size(), 1.0), distances(points_m.size());
  Spread fit;
  for (int round = 0; round < rounds; ++round) {
    fit = WeightedFit(points_m, weights);
    if (!(fit.width_m > width_min_m) || !fit.plane.normal.allFinite()) return std::nullopt;
    for (std::size_t i = 0; i < points_m.size(); ++i) distances[i] = std::abs(fit.plane.Distance_m(points_m[i]));
    fit.plane.sigma_m = std::max(kSigmaMin_m, 1.4826 * MedianOf(distances));
    for (std::size_t i = 0; i < points_m.size(); ++i) {
      const double ratio = fit.plane.Distance_m(points_m[i]) / (kTukey * fit.plane.sigma_m), rest = 1 - ratio * ratio;
      weights[i] = rest > 0 ? rest * rest : 0.0;
    }
  }
  return fit.plane;
}

PlaneFrame FrameOn(const FittedPlane& plane, const Eigen::Vector3d& near_m) {
  PlaneFrame frame;
  frame.origin_m = near_m - plane.normal * plane.Distance_m(near_m);
  const Eigen::Vector3d level = Eigen::Vector3d::UnitZ().cross(plane.normal);
  frame.u = level.norm() > 0.2 ? Eigen::Vector3d(level.normalized())
                               : Eigen::Vector3d(Eigen::Vector3d::UnitY().cross(plane.normal).normalized());
  frame.v = plane.normal.cross(frame.u);
  return frame;
}

std::vector<Piercing> Pierce(const CloudRays& rays, const FittedPlane& plane, const PlaneFrame& frame, double radius_m,
                             std::size_t budget) {
  const double range_m = frame.origin_m.norm();
  const double angle_rad = std::asin(std::min(0.94, radius_m / std::max(range_m, 1e-3)));
  std::vector<std::uint32_t> indices;
  rays.InCone((frame.origin_m / range_m).cast<float>(), angle_rad, budget, indices);
  const Eigen::Vector3f normal = plane.normal.cast<float>(), origin = frame.origin_m.cast<float>();
  const Eigen::Vector3f u = frame.u.cast<float>(), v = frame.v.cast<float>();
  const auto offset = static_cast<float>(plane.offset_m), tolerance = static_cast<float>(plane.Tolerance_m());
  const auto squared_m2 = static_cast<float>(radius_m * radius_m);
  std::vector<Piercing> piercings;
  piercings.reserve(indices.size());
  for (const std::uint32_t i : indices) {
    const float facing = -normal.dot(rays.directions[i]);
    if (facing < static_cast<float>(kGrazing)) continue;
    const Eigen::Vector3f on = rays.directions[i] * (offset / facing) - origin;
    if (on.squaredNorm() > squared_m2) continue;
    const float distance = normal.dot(rays.points_m[i]) + offset;
    const Evidence evidence = distance > tolerance    ? Evidence::kFront
                              : distance < -tolerance ? Evidence::kBehind
                                                      : Evidence::kOn;
    piercings.push_back({{u.dot(on), v.dot(on)}, evidence, i});
  }
  return piercings;
}

}  // namespace rigcal::detect
