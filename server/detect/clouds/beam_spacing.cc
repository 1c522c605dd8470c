#include "server/detect/clouds/beam_spacing.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

namespace rigcal::detect {
namespace {

constexpr double kGapMax_rad = 0.12;

// Span and widest gap of angles.
struct Gaps {
  double span_rad = 0, widest_rad = 0;
};

Gaps GapsOf(std::vector<float>& angles_rad) {
  std::sort(angles_rad.begin(), angles_rad.end());
  Gaps gaps{angles_rad.back() - angles_rad.front(), 0};
  for (std::size_t i = 1; i < angles_rad.size(); ++i)
    gaps.widest_rad = std::max<double>(gaps.widest_rad, angles_rad[i] - angles_rad[i - 1]);
  gaps.widest_rad = std::min(gaps.widest_rad, kGapMax_rad);
  return gaps;
}

// The point of the plane where the direction, turned by `turn` (a small vector), pierces it, less where it does
// unturned.
Eigen::Vector2d OnPlane(const FittedPlane& plane, const PlaneFrame& frame, const Eigen::Vector3d& turn) {
  const Eigen::Vector3d direction = frame.origin_m.normalized() + turn;
  const double facing = std::max(0.02, -plane.normal.dot(direction));
  return frame.Of(direction * (plane.offset_m / facing));
}

}  // namespace

BeamSpacing SpacingOf(const CloudRays& rays, const std::vector<std::uint32_t>& indices, const FittedPlane& plane,
                      const PlaneFrame& frame) {
  const Eigen::Vector3d middle = frame.origin_m.normalized();
  const Eigen::Vector3d pole = std::abs(middle.z()) < 0.9 ? Eigen::Vector3d::UnitZ() : Eigen::Vector3d::UnitY();
  const Eigen::Vector3d side = pole.cross(middle).normalized(), up = middle.cross(side);
  const Eigen::Vector3d forward = side.cross(pole);
  std::vector<float> elevations, azimuths;
  for (const std::uint32_t i : indices) {
    const Eigen::Vector3d d = rays.directions[i].cast<double>();
    elevations.push_back(static_cast<float>(std::asin(std::clamp(d.dot(pole), -1.0, 1.0))));
    azimuths.push_back(static_cast<float>(std::atan2(d.dot(side), d.dot(forward))));
  }
  const Gaps rows = GapsOf(elevations), columns = GapsOf(azimuths);
  const double area = std::max(rows.span_rad, 1e-4) * std::max(columns.span_rad, 1e-4);
  const double mean_rad = std::sqrt(area / static_cast<double>(indices.size()));
  double row_rad = std::max(mean_rad, rows.widest_rad), column_rad = std::max(mean_rad, columns.widest_rad);
  if (rows.widest_rad >= columns.widest_rad)
    column_rad = std::min(column_rad, area / row_rad / indices.size());
  else
    row_rad = std::min(row_rad, area / column_rad / indices.size());
  return {OnPlane(plane, frame, up * row_rad), OnPlane(plane, frame, side * column_rad)};
}

}  // namespace rigcal::detect
