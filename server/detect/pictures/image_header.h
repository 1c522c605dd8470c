// The dimensions that an encoded picture claims, read by hand so that nothing is allocated on their word.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "server/base/result.h"

namespace rigcal::detect {

struct ImageSize {
  std::int64_t width_px = 0, height_px = 0;
  friend bool operator==(const ImageSize&, const ImageSize&) = default;
};

// PNG (IHDR) or JPEG (first SOF segment). Reads within `encoded` only. Fails on any other format, on a header that is
// cut off, and on sizes that are zero or beyond the limit image_pixels.
[[nodiscard]] Result<ImageSize> ReadImageSize(std::span<const std::byte> encoded);
// A JPEG without its end: decoders would fill the rest with grey and say nothing. PNG decoders notice it themselves.
[[nodiscard]] bool IsCutOff(std::span<const std::byte> encoded);

}  // namespace rigcal::detect
