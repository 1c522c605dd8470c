// The colours of many cameras -> one coloured cloud.
#pragma once

#include <span>
#include <vector>

#include "server/cloud/camera_view.h"
#include "server/cloud/gains.h"

namespace rigcal::cloud {

constexpr Rgb kUncovered = {0, 200, 60};  // a point that no camera covers
constexpr std::uint8_t kNoCamera = 255;

struct ColouredCloud {
  std::vector<Eigen::Vector3f> points_m;  // in the lidar's frame
  std::vector<Rgb> rgb;
  std::vector<std::uint8_t> camera_idx;  // the camera with the most weight; kNoCamera
  std::vector<std::uint8_t> intensity;
  float step_rad = 0.01F;  // mean spacing of the beams
  Facing facing;
  std::vector<Gain> gains;  // by camera
  std::size_t covered = 0;
};

// `views` in the cameras' order, at most kCloudCamerasMax (limits.h) of them; their index is the camera's. The same on
// any number of threads.
[[nodiscard]] ColouredCloud Blend(Beams beams, std::span<const CameraView> views);

}  // namespace rigcal::cloud
