// A lidar scan of flat rectangles by ray casting: analytic truth for tests of the search for plates.
#pragma once

#include <Eigen/Geometry>
#include <cmath>
#include <limits>
#include <optional>
#include <random>
#include <vector>

#include "server/model/sensors/cloud.h"

namespace rigcal {

// A rectangle in the lidar's frame; u and v are unit and perpendicular, halves in metres.
struct Panel {
  Eigen::Vector3d centre_m, u, v;
  Eigen::Vector2d half_m;

  [[nodiscard]] Eigen::Vector3d Normal() const { return u.cross(v); }
  [[nodiscard]] std::optional<double> Hit(const Eigen::Vector3d& direction) const {
    const double facing = Normal().dot(direction);
    if (std::abs(facing) < 1e-9) return std::nullopt;
    const double range_m = Normal().dot(centre_m) / facing;
    const Eigen::Vector3d off = range_m * direction - centre_m;
    if (range_m < 0.1 || std::abs(u.dot(off)) > half_m.x() || std::abs(v.dot(off)) > half_m.y()) return std::nullopt;
    return range_m;
  }
};

// Width along u, height along v, facing the sensor (u, v, outward normal right-handed), then turned: about the vertical
// by yaw, about the level axis by pitch, about its normal by roll.
inline Panel PlateAt(const Eigen::Vector3d& centre_m, const Eigen::Vector2d& size_m, double yaw_rad, double pitch_rad,
                     double roll_rad) {
  using Eigen::AngleAxisd, Eigen::Vector3d;
  const double azimuth = std::atan2(centre_m.y(), centre_m.x());
  const Eigen::Matrix3d R = (AngleAxisd(azimuth + yaw_rad, Vector3d::UnitZ()) *
                             AngleAxisd(pitch_rad, Vector3d::UnitY()) * AngleAxisd(roll_rad, Vector3d::UnitX()))
                                .toRotationMatrix();
  return {centre_m, -R.col(1), R.col(2), size_m / 2};
}

// Four sides and a top, standing about centre_m.
inline std::vector<Panel> BoxAt(const Eigen::Vector3d& centre_m, const Eigen::Vector3d& size_m) {
  const Eigen::Vector3d x = Eigen::Vector3d::UnitX(), y = Eigen::Vector3d::UnitY(), z = Eigen::Vector3d::UnitZ();
  const Eigen::Vector3d h = size_m / 2;
  return {{centre_m + x * h.x(), y, z, {h.y(), h.z()}},
          {centre_m - x * h.x(), y, z, {h.y(), h.z()}},
          {centre_m + y * h.y(), x, z, {h.x(), h.z()}},
          {centre_m - y * h.y(), x, z, {h.x(), h.z()}},
          {centre_m + z * h.z(), x, y, {h.x(), h.y()}}};
}

struct Beams {
  int rings = 16;
  double bottom_deg = -15, top_deg = 15, step_deg = 0.2, from_deg = -180, till_deg = 180;
  double noise_m = 0.02;
};

// Every beam's nearest hit with noise along the beam; between two panels a pixel may be mixed (half way), as real ones
// are.
inline Cloud Scan(const std::vector<Panel>& panels, const Beams& beams, unsigned seed = 1) {
  std::mt19937 random(seed);
  std::normal_distribution<double> noise(0.0, beams.noise_m);
  Cloud cloud;
  const auto nearest = [&](double azimuth_deg, double elevation_deg, Eigen::Vector3d& direction) {
    const double a = azimuth_deg * M_PI / 180, e = elevation_deg * M_PI / 180;
    direction = {std::cos(e) * std::cos(a), std::cos(e) * std::sin(a), std::sin(e)};
    double range_m = std::numeric_limits<double>::infinity();
    for (const Panel& panel : panels)
      if (const auto hit = panel.Hit(direction)) range_m = std::min(range_m, *hit);
    return range_m;
  };
  for (double azimuth = beams.from_deg; azimuth < beams.till_deg; azimuth += beams.step_deg)
    for (int ring = 0; ring < beams.rings; ++ring) {
      const double elevation = beams.bottom_deg + (beams.top_deg - beams.bottom_deg) * ring / (beams.rings - 1);
      Eigen::Vector3d direction, beside;
      double range_m = nearest(azimuth, elevation, direction);
      const double other_m = nearest(azimuth + 0.06, elevation, beside);
      if (std::isfinite(range_m) && std::isfinite(other_m) && std::abs(range_m - other_m) > 0.1)
        range_m = (range_m + other_m) / 2;
      if (std::isfinite(range_m)) cloud.points_m.push_back((direction * (range_m + noise(random))).cast<float>());
    }
  return cloud;
}

}  // namespace rigcal
