// The picture that a camera takes of a scene.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "client/sim/rig/scene.h"
#include "client/sim/views/ray_grid.h"
#include "server/math/se3.h"

namespace rigcal::sim {

struct Picture {
  int width_px = 0, height_px = 0;
  std::vector<std::uint8_t> bgr;  // row by row, three bytes a pixel
};

// Blue, green, red; with blur, vignetting and noise. `key`: of the noise.
[[nodiscard]] Picture TakePicture(const Scene& scene, const CameraTruth& camera, const RayGrid& grid,
                                  const Se3& T_world_cam, std::uint64_t key);

enum class PictureFormat { kJpeg, kPng };
[[nodiscard]] std::string SuffixOf(PictureFormat format);  // "jpg", "png"
// JPEG at quality 90, as the robot of the paper stores them; PNG loses nothing and takes far longer.
[[nodiscard]] Result<std::string> Encoded(const Picture& picture, PictureFormat format);

}  // namespace rigcal::sim
