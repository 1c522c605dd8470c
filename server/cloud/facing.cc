#include "server/cloud/facing.h"

#include <Eigen/Eigenvalues>

#include "server/base/process/parallel_for.h"

namespace rigcal::cloud {
namespace {

constexpr float kBundleMin_rad = 0.05F, kBundleMax_rad = 0.18F;
constexpr float kBundleSteps = 5;    // of the mean
constexpr double kManyRings = 0.6;   // spread of their elevations in steps: of two rings 0.5 at most, of three 0.8
constexpr float kWiderSteps = 5.0F;  // of the wider one: two rings fit any slope, from one surface to another as well
constexpr int kPointsMin = 6;
// Of the middle variance: above, the bundle is no plane; a line has no middle variance.
constexpr double kThicknessMax = 0.15, kWidthMin = 0.004;
// A plane that is seen at a low angle is as thin as noise looks from there; a step between two surfaces is not.
constexpr double kNoise_m = 0.03, kThicknessPerWidth = 0.1;

struct Bundle {
  int count = 0;
  double up = 0, up_squares = 0;  // of the sine of the rays' elevation
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  Eigen::Matrix3d squares = Eigen::Matrix3d::Zero();
};

constexpr std::size_t kParts = 8;               // summed in their order, whatever thread did which
constexpr std::size_t kPointsWanted = 300'000;  // of a larger cloud every n-th point is enough

using Bundles = std::vector<Bundle>;
using StepUp = std::function<float(float)>;

// Whether the rays are of three rings or more.
bool OfManyRings(const Bundle& bundle, const StepUp& step_up_rad) {
  const double up = bundle.up / bundle.count, step_rad = step_up_rad(static_cast<float>(up));
  const double variance = bundle.up_squares / bundle.count - up * up;
  return variance > std::pow(kManyRings * step_rad, 2) * (1 - up * up);
}

Eigen::Vector3f NormalOf(const Bundle& bundle, double width_rad, const StepUp& step_up_rad) {
  if (bundle.count < kPointsMin) return Eigen::Vector3f::Zero();
  const Eigen::Vector3d mean = bundle.sum / bundle.count;
  if (!OfManyRings(bundle, step_up_rad)) return -mean.normalized().cast<float>();
  const Eigen::Matrix3d covariance = bundle.squares / bundle.count - mean * mean.transpose();
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(covariance);
  const Eigen::Vector3d& variances = solver.eigenvalues();
  if (!(variances(1) > kWidthMin * variances(2))) return Eigen::Vector3f::Zero();
  if (!(variances(0) < kThicknessMax * variances(1))) return -mean.normalized().cast<float>();
  const Eigen::Vector3d normal = solver.eigenvectors().col(0);
  const double range_m = mean.norm(), spread_m = range_m * width_rad / std::sqrt(12.0);
  const double thickness_m = std::sqrt(std::max(0.0, variances(0)));
  if (thickness_m > kNoise_m * std::abs(normal.dot(mean)) / range_m + kThicknessPerWidth * spread_m)
    return -mean.normalized().cast<float>();
  return (normal.dot(mean) > 0 ? Eigen::Vector3d(-normal) : normal).cast<float>();
}

void Add(const Eigen::Vector3f& point_m, Bundle& bundle) {
  const Eigen::Vector3d point = point_m.cast<double>();
  const double up = point.z() / std::max(point.norm(), 1e-6);
  bundle.up += up, bundle.up_squares += up * up;
  ++bundle.count, bundle.sum += point, bundle.squares += point * point.transpose();
}

void Add(const Bundle& other, Bundle& bundle) {
  bundle.up += other.up, bundle.up_squares += other.up_squares;
  bundle.count += other.count, bundle.sum += other.sum, bundle.squares += other.squares;
}

}  // namespace

Facing::Facing(const std::vector<Eigen::Vector3f>& points_m, float azimuth_step_rad, float elevation_step_rad,
               const std::function<float(float)>& step_up_rad) {
  const float wanted_rad = std::max(kBundleSteps * std::sqrt(azimuth_step_rad * elevation_step_rad),
                                    kWiderSteps * std::max(azimuth_step_rad, elevation_step_rad));
  const float width_rad = std::clamp(wanted_rad, kBundleMin_rad, kBundleMax_rad);
  per_quarter_ = static_cast<float>(M_PI_2) / width_rad;
  columns_ = static_cast<int>(4 * per_quarter_) + 1, rows_ = static_cast<int>(2 * per_quarter_) + 1;
  const auto count = static_cast<std::size_t>(columns_ * rows_);
  const std::size_t stride = std::max<std::size_t>(1, points_m.size() / kPointsWanted);
  std::vector<Bundles> parts(kParts, Bundles(count));
  ParallelFor(kParts, [&](std::size_t part) {
    for (std::size_t i = part * stride; i < points_m.size(); i += kParts * stride)
      Add(points_m[i], parts[part][IndexOf(points_m[i])]);
  });
  normals_.resize(count);
  ParallelFor(static_cast<std::size_t>(rows_), [&](std::size_t row) {
    for (std::size_t b = row * static_cast<std::size_t>(columns_); b < (row + 1) * static_cast<std::size_t>(columns_);
         ++b) {
      Bundle whole;
      for (const Bundles& part : parts) Add(part[b], whole);
      normals_[b] = NormalOf(whole, static_cast<double>(width_rad), step_up_rad);
    }
  });
}

}  // namespace rigcal::cloud
