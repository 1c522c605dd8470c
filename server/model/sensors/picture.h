// A decoded picture: 8-bit colour, rows without gaps.
#pragma once

#include <cstdint>
#include <vector>

namespace rigcal {

struct Picture {
  int width_px = 0, height_px = 0;
  std::vector<std::uint8_t> rgb;  // row-major, 3 * width_px * height_px
};

}  // namespace rigcal
