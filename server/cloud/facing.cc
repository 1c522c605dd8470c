#include "server/cloud/facing.h"

#include <Eigen/Eigenvalues>

#include "server/base/parallel_for.h"

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

constexpr std::size_t kParts = 8;               // summed in their order, whatever thread did which
constexpr std::size_t kPointsWanted = 300'000;  // of a larger cloud every n-th point is enough

using Bundles = std::vector<Bundle>;

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

void Add(const Eigen::Vector3f& point_m, Bundle& bundle) {
  const Eigen::Vector3d point = point_m.cast<double>();
  ++bundle.count, bundle.sum += point, bundle.squares += point * point.transpose();
}

void Add(const Bundle& other, Bundle& bundle) {
  bundle.count += other.count, bundle.sum += other.sum, bundle.squares += other.squares;
}

}  // namespace

Facing::Facing(const std::vector<Eigen::Vector3f>& points_m, float step_rad)
    : per_quarter_(static_cast<float>(M_PI_2) / std::clamp(kBundleSteps * step_rad, kBundleMin_rad, kBundleMax_rad)) {
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
      normals_[b] = NormalOf(whole);
    }
  });
}

}  // namespace rigcal::cloud
