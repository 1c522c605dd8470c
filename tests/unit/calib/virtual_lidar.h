// A fisheye camera, a lidar and a board with known truth. Pictures come from OpenCV's projection, clouds from rays that
// meet the board's plane: neither shares code with what is under test.
#pragma once

#include <vector>

#include "server/calib/lidar_camera/lidar_camera.h"

namespace rigcal::calib {

struct VirtualLidarRig {
  CameraIntrinsics intrinsics{600, 602, 639, 361, {-0.05, 0.01, -0.004, 0.001}, CameraModel::kFisheyeKb4};
  Se3 T_cam_lidar;
  Target board;
  double corner_sigma_px = 0.0, range_sigma_m = 0.0, range_bias_m = 0.0;
  bool decoys = false;  // every cloud also has other patches, and lists one of them first
  VirtualLidarRig();
};

// Boards 2 to 5 m before the camera, tilted to all sides by up to `tilt_rad`.
std::vector<Se3> BoardsBefore(int count, double tilt_rad = 0.6);
LidarCameraProblem Recorded(const VirtualLidarRig& rig, const std::vector<Se3>& T_cam_board, unsigned seed);

}  // namespace rigcal::calib
