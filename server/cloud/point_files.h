// A coloured cloud as files: PLY for other programs, points.bin for the page's viewer.
#pragma once

#include <string>

#include "server/cloud/blend.h"

namespace rigcal::cloud {

// Binary little endian: float x y z, uchar red green blue, uchar camera (255: none), uchar intensity.
[[nodiscard]] std::string WritePly(const ColouredCloud& cloud);

constexpr float kViewerReach_m = 300;
// Little endian: "RCLD", uint32 version 1, uint32 count, float32 origin_m[3], float32 step_m; then per point 12 bytes:
// int16 x y z (position = origin + step * value), uint8 r g b, uint8 camera (255: none), uint8 intensity, uint8 0.
// Points further than kViewerReach_m from the lidar are left out, so that the step stays below 10 mm.
[[nodiscard]] std::string WriteViewerPoints(const ColouredCloud& cloud);

}  // namespace rigcal::cloud
