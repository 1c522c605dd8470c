// Beams of a turning lidar err each by a constant of its own. Which beam took a point is not said: points whose
// elevation is the same to 1.5 degrees count as of one beam, the same groups in every problem of a lidar.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "server/base/ids.h"
#include "server/model/features.h"

namespace rigcal::calib {

constexpr std::size_t kBeamGroups = 60;
// By elevation above the plane across the lidar's z, about which beams turn; what is steeper belongs to the last.
[[nodiscard]] std::size_t BeamGroupOf(const Eigen::Vector3f& p_m);
// Of the contribution of these constants: the same in all edges of the lidar, group by group, so that a graph knows
// them for the same.
[[nodiscard]] std::string SingleBeamsOf(const SensorId& lidar);

void MarkBeams(const PlanePatch& patch, std::vector<char>& seen);  // `seen`: kBeamGroups long
// The patch with the ranges of one group longer.
[[nodiscard]] PlanePatch WithBeamsMoved(PlanePatch patch, std::size_t group, double longer_m);

}  // namespace rigcal::calib
