// What the captures say about errors that all of them share: a bias of the lidar's ranges, and a board of another size.
#pragma once

#include "server/calib/lidar_camera_work.h"

namespace rigcal::calib {

// Fills range_bias_*, board_scale_* and scale_fits_better. Each is fitted beside the pose with weights of its own, so
// that the misfit of the other explanation does not hide it.
void EstimateSystematics(const LidarCameraProblem& problem, const LidarCameraWork& work, LidarCameraEstimate& estimate);
// Widens their sigmas, which so far are those of the points alone, by what leaving captures out and the given
// intrinsics' own sigmas do to them: poses of the boards err alike in all captures, and small tilts turn a tenth of a
// millimetre of that into centimetres of bias.
[[nodiscard]] Status WidenSystematics(const LidarCameraProblem& problem, LidarCameraEstimate& estimate);

}  // namespace rigcal::calib
