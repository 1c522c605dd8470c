// A cloud as the lidar sampled it: its finite points, and how far apart its beams are.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

#include "server/cloud/facing.h"
#include "server/model/sensors/cloud.h"

namespace rigcal::cloud {

struct Beams {
  std::vector<Eigen::Vector3f> points_m;  // in the lidar's frame
  std::vector<std::uint8_t> intensity;    // one per point; 0 where the cloud has none
  std::size_t stride = 1;                 // every stride-th point was taken
  float azimuth_step_rad = 0.01F;         // about z of the lidar
  float elevation_step_rad = 0.01F;       // up from there, the median of what follows
  // By height of the ray, kHeights steps of its sine from -1 to 1: many lidars have denser beams in the middle.
  static constexpr int kHeights = 1024;
  std::vector<float> steps_up_rad = std::vector<float>(kHeights, 0.01F);

  Facing facing;

  // Halves of a step, and sideways a little more, so that neighbours at one distance leave no chink. Not so upwards:
  // the next ring on the ground is much further and must not be hidden.
  static constexpr float kLevel = 0.75F, kUpright = 0.5F;

  // The half sides of the patch of surface that a beam stands for, one level and one upright as the lidar sees them. It
  // lies in the surface: else, on a floor seen at a low angle, every ring would hide the next from a lower camera.
  void PatchOf(const Eigen::Vector3f& point_m, Eigen::Vector3f& level_m, Eigen::Vector3f& upright_m) const {
    const float level = point_m.head<2>().norm(), range = point_m.norm();
    const Eigen::Vector3f across =
        level > 0 ? Eigen::Vector3f(-point_m.y() / level, point_m.x() / level, 0) : Eigen::Vector3f(0, 1, 0);
    const Eigen::Vector3f up = point_m.cross(across);
    const float level_half = kLevel * azimuth_step_rad * std::max(level, 0.5F * range);
    level_m = level_half * across;
    upright_m = kUpright * StepUp_rad(point_m.z() / std::max(range, 1e-6F)) * up;
    LayInSurface(point_m, level_m, upright_m);
  }
  // Along the ray, until they lie in the plane; hardly longer than kSteepest times.
  void LayInSurface(const Eigen::Vector3f& point_m, Eigen::Vector3f& level_m, Eigen::Vector3f& upright_m) const {
    constexpr float kSteepest = 12;
    const Eigen::Vector3f normal = facing.At(point_m);
    const float towards = -normal.dot(point_m);
    if (!(towards > 0)) return;
    const float along = 1 / std::max(towards, point_m.norm() / kSteepest);
    level_m += (normal.dot(level_m) * along) * point_m, upright_m += (normal.dot(upright_m) * along) * point_m;
  }
  [[nodiscard]] float StepUp_rad(float sine) const {
    const int height = static_cast<int>((sine + 1) * (0.5F * kHeights));
    return steps_up_rad[static_cast<std::size_t>(std::clamp(height, 0, kHeights - 1))];
  }
  // The wider of the two.
  [[nodiscard]] float SpacingAt_m(const Eigen::Vector3f& point_m) const {
    const float range = std::max(point_m.norm(), 1e-6F);
    return range * std::max(azimuth_step_rad, StepUp_rad(point_m.z() / range));
  }
  [[nodiscard]] float MeanStep_rad() const { return std::sqrt(azimuth_step_rad * elevation_step_rad); }
};

// Beyond the limit kColouredPointsMax the cloud is thinned evenly. The field "intensity" (or "reflectivity", "i") is
// stretched to its 99 % quantile.
[[nodiscard]] Beams BeamsOf(const Cloud& cloud);

}  // namespace rigcal::cloud
