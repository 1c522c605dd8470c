// Exposure balance: one gain per camera and colour, from the points that several cameras see.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "server/cloud/camera_view.h"

namespace rigcal::cloud {

using Gain = std::array<float, 3>;  // factors on r, g, b

// Medians of the colours' ratios over the points of each pair of cameras, then least squares of the logarithms: points
// painted wrongly, glare and saturation have no say. The gains of cameras that are linked by overlaps have the
// geometric mean 1 (where overlaps are large); a camera without overlap has gain 1. Within a factor of 4.
[[nodiscard]] std::vector<Gain> BalancedGains(std::span<const CameraView> views);

}  // namespace rigcal::cloud
