#include "server/cloud/viewpoint.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

namespace rigcal::cloud {
namespace {

constexpr float kTurn_rad = 0.62F, kDown_rad = 0.62F;  // of the oblique view
constexpr float kFrontHalfWidth = 1.15F;               // x / z at the edge of the front view: 98 degrees across
constexpr float kMargin = 1.12F;
constexpr double kFarShare = 0.75;

float Quantile(std::vector<float> values, double share) {
  if (values.empty()) return 0;
  const auto at = values.begin() + static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), at, values.end());
  return *at;
}

// Rows: right, down, into the picture.
Eigen::Matrix3f Looking(const Eigen::Vector3f& into, const Eigen::Vector3f& up) {
  Eigen::Matrix3f R;
  const Eigen::Vector3f right = into.cross(up).normalized();
  R.row(0) = right.transpose(), R.row(1) = into.cross(right).transpose(), R.row(2) = into.transpose();
  return R;
}

Eigen::Matrix3f RotationOf(const Stand& stand, Angle angle) {
  if (angle == Angle::kFront) return Looking(stand.forward, stand.up);
  if (angle == Angle::kTop) return Looking(-stand.up, stand.forward);
  const Eigen::Vector3f turned = Eigen::AngleAxisf(kTurn_rad, stand.up) * stand.forward;
  const Eigen::Vector3f into = std::cos(kDown_rad) * turned - std::sin(kDown_rad) * stand.up;
  return Looking(into.normalized(), stand.up);
}

void FitPerspective(const std::vector<Eigen::Vector3f>& points, int width_px, int height_px, Viewpoint& view) {
  const float half_height = kFrontHalfWidth * static_cast<float>(height_px) / static_cast<float>(width_px);
  std::vector<float> heights, depths;
  for (const Eigen::Vector3f& point : points) {
    const Eigen::Vector3f p = view.R_view_lidar * point;
    if (p.z() < 0.3F || std::abs(p.x()) > kFrontHalfWidth * p.z()) continue;
    heights.push_back(p.y() / p.z()), depths.push_back(p.z());
  }
  // A scan that fills only a band of the picture is brought nearer; a higher one is shown around its middle.
  const float low = Quantile(heights, 0.01), high = Quantile(heights, 0.99);
  const float zoom = std::clamp(2 * half_height / (kMargin * std::max(high - low, 1e-3F)), 1.0F, 2.0F);
  view.scale_px = zoom * static_cast<float>(width_px) / (2 * kFrontHalfWidth);
  view.middle = {0, 0.5F * (low + high)};
  view.reach_m = Quantile(depths, 0.5);
}

void FitParallel(const std::vector<Eigen::Vector3f>& points, int width_px, int height_px, Viewpoint& view) {
  std::vector<float> ranges;
  for (const Eigen::Vector3f& point : points) ranges.push_back(point.norm());
  view.reach_m = std::max(0.5F, Quantile(ranges, kFarShare));
  std::vector<float> across, down;
  for (const Eigen::Vector3f& point : points) {
    if (point.norm() > view.reach_m) continue;
    const Eigen::Vector3f p = view.R_view_lidar * point;
    across.push_back(p.x()), down.push_back(p.y());
  }
  // With the lidar itself, which is at zero.
  const Eigen::Vector2f low(std::min(0.0F, Quantile(across, 0.01)), std::min(0.0F, Quantile(down, 0.01)));
  const Eigen::Vector2f high(std::max(0.0F, Quantile(across, 0.99)), std::max(0.0F, Quantile(down, 0.99)));
  const Eigen::Vector2f size = (kMargin * (high - low)).cwiseMax(1e-2F);
  view.scale_px = std::min(static_cast<float>(width_px) / size.x(), static_cast<float>(height_px) / size.y());
  view.middle = 0.5F * (low + high);
}

}  // namespace

Stand StandOf(const Eigen::Vector3d& up, const Eigen::Vector3d& forward) {
  constexpr double kSays = 0.2;
  Stand stand;
  if (up.norm() > kSays) stand.up = up.normalized().cast<float>();
  const Eigen::Vector3f ahead = forward.cast<float>();
  for (const Eigen::Vector3f& wanted :
       {ahead, Eigen::Vector3f(Eigen::Vector3f::UnitX()), Eigen::Vector3f(Eigen::Vector3f::UnitY())}) {
    const Eigen::Vector3f level = wanted - stand.up.dot(wanted) * stand.up;
    if (level.norm() < 0.2F) continue;
    stand.forward = level.normalized();
    return stand;
  }
  return stand;
}

Stand FacingMost(const Stand& stand, const std::vector<Eigen::Vector3f>& points_m) {
  constexpr int kHeadings = 16;
  constexpr std::size_t kLookedAt = 20'000;
  constexpr float kHalfHeight = 0.62F * kFrontHalfWidth;
  const std::size_t jump = std::max<std::size_t>(1, points_m.size() / kLookedAt);
  constexpr double kNearlyAsMany = 1.5;
  Stand best = stand;
  double most = 0;
  for (int heading = 0; heading < kHeadings; ++heading) {
    Stand turned = stand;
    turned.forward = Eigen::AngleAxisf(2 * static_cast<float>(M_PI) * heading / kHeadings, stand.up) * stand.forward;
    const Eigen::Matrix3f R = RotationOf(turned, Angle::kFront);
    std::size_t seen = 0;
    for (std::size_t i = 0; i < points_m.size(); i += jump) {
      const Eigen::Vector3f p = R * points_m[i];
      const bool inside = std::abs(p.x()) < kFrontHalfWidth * p.z() && std::abs(p.y()) < kHalfHeight * p.z();
      seen += p.z() > 0.3F && inside ? 1 : 0;
    }
    const double worth = static_cast<double>(seen) * (heading == 0 ? kNearlyAsMany : 1.0);
    if (worth <= most) continue;
    most = worth, best = turned;
  }
  return best;
}

Viewpoint ViewpointOf(const std::vector<Eigen::Vector3f>& points_m, const Stand& stand, Angle angle, int width_px,
                      int height_px) {
  Viewpoint view;
  view.R_view_lidar = RotationOf(stand, angle);
  view.perspective = angle == Angle::kFront;
  view.perspective ? FitPerspective(points_m, width_px, height_px, view)
                   : FitParallel(points_m, width_px, height_px, view);
  return view;
}

}  // namespace rigcal::cloud
