// What the numbers of a lidar's .bin are: nothing in such a file says so.
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "server/base/result.h"
#include "server/model/sensors/cloud_layout.h"

namespace rigcal::formats {

// Good if the bytes have this layout's size, or, where none is given, can be nothing but KITTI's: 4 float32 a point,
// x y z intensity. That is so where numbers that stand 4 apart are more alike than those that stand any other number
// apart, multiples aside, no longer stride tells them apart better, and places lie within 1 km; by chance it is not,
// from 256 points on. The error names file and sensor and gives the line for session.yaml.
[[nodiscard]] Status CheckBinLayout(std::string_view bytes, const std::optional<CloudLayout>& layout,
                                    const std::string& name);

}  // namespace rigcal::formats
