// A decoded picture: 8-bit grey, rows without gaps.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "server/base/result.h"
#include "server/model/sensors/picture.h"

namespace rigcal::detect {

struct GreyImage {
  int width_px = 0, height_px = 0;
  std::vector<std::uint8_t> pixels;  // row-major, width_px * height_px

  // 0 is the top left pixel's column and row; inside the picture, not checked.
  [[nodiscard]] std::uint8_t At(int x, int y) const {
    return pixels[static_cast<std::size_t>(y) * static_cast<std::size_t>(width_px) + static_cast<std::size_t>(x)];
  }
  // Bilinear between pixel centres, of the nearest place inside. Finite coordinates; at least one pixel.
  [[nodiscard]] double Between(double x, double y) const;
};

// The pixel grid as stored: an orientation tag is ignored, because intrinsics belong to the sensor's grid. 16 bit is
// stretched between its 0.1 % and 99.9 % quantiles. A size that the bytes cannot hold is refused before anything is
// allocated. Fails in words. Throws std::bad_alloc where there is no memory: that is no fault of the picture.
[[nodiscard]] Result<GreyImage> DecodeGrey(std::span<const std::byte> encoded);
// The same in colour; a grey picture has three equal colours.
[[nodiscard]] Result<Picture> DecodeColour(std::span<const std::byte> encoded);

}  // namespace rigcal::detect
