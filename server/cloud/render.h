// A coloured cloud -> pictures of it.
#pragma once

#include <string>

#include "server/cloud/blend.h"
#include "server/cloud/viewpoint.h"

namespace rigcal::cloud {

enum class Background { kDark, kLight };

struct RenderOptions {
  int width_px = 1280, height_px = 800;
  Background background = Background::kDark;
};

// PNG. Points are discs as large as the beams' spacing where they are; edges of depth are shaded; surfaces that face
// away are left out, so that one looks into a room. A bar of some metres: true everywhere in the parallel views, true
// at the distance it names in the front view, which is seen from the lidar. The same input gives the same bytes. Throws
// what OpenCV throws.
[[nodiscard]] std::string RenderPng(const ColouredCloud& cloud, const Stand& stand, Angle angle,
                                    const RenderOptions& options = {});

}  // namespace rigcal::cloud
