#include "server/calib/core/range_constants.h"

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

void AddRangeBias(const SensorId& lidar, double sigma_m, const WithRanges& solved,
                  std::vector<GivenConstant>& constants) {
  if (!(sigma_m > 0)) return;
  constants.push_back({"range bias of " + lidar.str(), [=](double steps) { return solved(steps * sigma_m); }});
}

void AddBeams(const Sensor& lidar, const std::vector<char>& seen, const Se3& T_a_b, const WithBeams& solved,
              std::vector<GivenConstant>& constants) {
  const double sigma_m = lidar.range_bias_sigma_m.value_or(0.0);
  if (!(sigma_m > 0)) return;
  for (std::size_t group = 0; group < seen.size(); ++group)
    constants.push_back({SingleBeamsOf(lidar.id), [=, is_seen = seen[group]](double steps) -> Result<Se3> {
                           return is_seen == 0 ? T_a_b : solved(group, steps * sigma_m);
                         }});
}

}  // namespace rigcal::calib
