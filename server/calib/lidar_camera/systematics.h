// What the captures say about errors that all of them share: a bias of the lidar's ranges, and a board of another size.
#pragma once

#include "server/calib/lidar_camera/lidar_camera_work.h"

namespace rigcal::calib {

// Fills range_bias_*, board_scale_* and scale_fits_better. Each is fitted beside the pose with weights of its own, so
// that the misfit of the other explanation does not hide it.
void EstimateSystematics(const LidarCameraProblem& problem, const LidarCameraWork& work, LidarCameraEstimate& estimate);

struct Systematics {
  double range_bias_m = 0, board_scale_ratio = 0;
};
// Of an estimate solved again, with its weights: one step from a known scale. NaN: it cannot tell.
[[nodiscard]] Systematics SystematicsNear(LidarCameraWork work, double board_scale_ratio);
// Widens their sigmas, which so far are those of the points alone, by what the corners do to them by way of the
// intrinsics, by leaving captures out (if there are enough) and by the given intrinsics' own sigmas; forgets both where
// one of those cannot be told: poses of the boards err alike in all captures, and small tilts turn a tenth of a
// millimetre of that into centimetres of bias.
[[nodiscard]] Status WidenSystematics(const LidarCameraProblem& problem, LidarCameraEstimate& estimate);

}  // namespace rigcal::calib
