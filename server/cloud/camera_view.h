// What one camera saw of a cloud: which points, where in its picture, in which colour, and how much to believe it.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "server/cloud/beams.h"
#include "server/math/se3.h"
#include "server/model/sensors/camera.h"
#include "server/model/sensors/picture.h"

namespace rigcal::cloud {

using Rgb = std::array<std::uint8_t, 3>;

struct CloudCamera {
  CameraIntrinsics intrinsics;  // of the picture's own grid
  Se3 T_cam_lidar;
};

struct SeenPoint {
  std::uint32_t point_idx = 0;
  float u_px = 0, v_px = 0;
  float range_m = 0;  // from the camera
  float weight = 0;   // of its colour among cameras; positive
  Rgb rgb{};          // between pixels, bilinear
};

// Points that nothing hides, ascending, in parts: part k holds points kPart * k to kPart * (k + 1) - 1.
struct CameraView {
  static constexpr std::size_t kPart = 16384;
  std::vector<std::vector<SeenPoint>> parts;

  // Of all parts together.
  [[nodiscard]] std::size_t Count() const {
    std::size_t count = 0;
    for (const auto& part : parts) count += part.size();
    return count;
  }
};

// A point is hidden where the patch of another beam lies in front of it, by more than the beams' spacing explains. The
// weight falls with the angle from the optical axis, with the angle between the rays of camera and lidar (the larger it
// is, the further an error of range or pose moves the colour), and towards the picture's border. The same on any number
// of threads. An empty picture sees nothing.
[[nodiscard]] CameraView See(const Beams& beams, const CloudCamera& camera, const Picture& picture);

// The weight's part of the border: 1 inside, down to a little at the edge itself (a point that only this camera sees is
// painted all the same).
[[nodiscard]] float BorderWeight(float u_px, float v_px, int width_px, int height_px);

}  // namespace rigcal::cloud
