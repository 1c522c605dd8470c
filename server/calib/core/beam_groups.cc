#include "server/calib/core/beam_groups.h"

#include <algorithm>
#include <cmath>

namespace rigcal::calib {
namespace {

constexpr double kGroupsFrom_rad = -M_PI / 4, kGroup_rad = M_PI / 2 / kBeamGroups;

}  // namespace

std::size_t BeamGroupOf(const Eigen::Vector3f& p_m) {
  const double elevation_rad = std::atan2(p_m.z(), std::hypot(p_m.x(), p_m.y()));
  const double at = std::floor((elevation_rad - kGroupsFrom_rad) / kGroup_rad);
  return static_cast<std::size_t>(std::clamp(at, 0.0, kBeamGroups - 1.0));
}

std::string SingleBeamsOf(const SensorId& lidar) { return "range biases of single beams of " + lidar.str(); }

void MarkBeams(const PlanePatch& patch, std::vector<char>& seen) {
  for (const Eigen::Vector3f& p : patch.points_m) seen[BeamGroupOf(p)] = 1;
}

PlanePatch WithBeamsMoved(PlanePatch patch, std::size_t group, double longer_m) {
  for (Eigen::Vector3f& p : patch.points_m)
    if (BeamGroupOf(p) == group) p += static_cast<float>(longer_m) * p.normalized();
  return patch;
}

}  // namespace rigcal::calib
