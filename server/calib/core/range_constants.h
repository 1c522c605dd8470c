// What errs of a lidar's ranges alike in all captures: all of them by one bias, and beams of a turning lidar each by a
// constant of its own. Which beam took a point is not said: points whose elevation is the same to 1.5 degrees count as
// of one beam, the same groups in every problem of a lidar.
#pragma once

#include <Eigen/Core>
#include <functional>
#include <string>
#include <vector>

#include "server/calib/core/leave_one_out.h"
#include "server/model/features.h"
#include "server/model/session.h"

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

// The answer with all ranges, or those of one group of beams, longer by so much.
using WithRanges = std::function<Result<Se3>(double longer_m)>;
using WithBeams = std::function<Result<Se3>(std::size_t group, double longer_m)>;
// "range bias of LIDAR", solved anew at every call. Without a sigma nothing is added.
void AddRangeBias(const SensorId& lidar, double sigma_m, const WithRanges& solved,
                  std::vector<GivenConstant>& constants);
// Every group errs by the lidar's range_bias_sigma_m alone as well; those not in `seen` leave the answer T_a_b. One
// constant per group, so that edges of a lidar share them by their order.
void AddBeams(const Sensor& lidar, const std::vector<char>& seen, const Se3& T_a_b, const WithBeams& solved,
              std::vector<GivenConstant>& constants);

}  // namespace rigcal::calib
