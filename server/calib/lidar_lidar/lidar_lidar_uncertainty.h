// How sure a lidar-lidar pose is.
#pragma once

#include "server/calib/lidar_lidar/lidar_lidar_work.h"

namespace rigcal::calib {

constexpr std::size_t kCloudsForJackknife = 5;  // captures; fewer: the model's
constexpr std::size_t kCloudsEnough = 8;        // fewer: a note says that sigma is rough

// Of T_a_b. `d`: block vectors of T_map_moving from LeaveBlocksOut(). The jackknife over captures shrunk towards the
// model; with few captures the model: the information of the surfaces with the scatter between blocks of voxels. What
// NDT and its polish disagree by, and ranges that are all off together, are contributions. No information along
// `unknown`.
[[nodiscard]] Result<Uncertainty> LidarLidarUncertainty(const LidarLidarProblem& problem, const LidarLidarWork& work,
                                                        const LidarLidarPose& pose, const Directions& unknown,
                                                        const std::vector<SurfacePairs>& pairs,
                                                        const std::vector<Vector6d>& d);

}  // namespace rigcal::calib
