// One level of an image pyramid, in the shape that filters like.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "server/detect/pictures/grey_image.h"

namespace rigcal::detect {

// Grey 0 to 255, with kPad pixels more on every side that repeat the border.
struct GreyLevel {
  static constexpr int kPad = 6;

  int width_px = 0, height_px = 0;
  double scale = 1.0;  // of this level against the picture
  std::vector<std::int16_t> pixels;

  // From a row to the next, in pixels: both paddings included.
  [[nodiscard]] std::ptrdiff_t Stride() const { return width_px + 2 * kPad; }
  // Row y from -kPad to height_px + kPad - 1; the pointer is to x = 0.
  [[nodiscard]] const std::int16_t* Row(int y) const { return pixels.data() + (y + kPad) * Stride() + kPad; }
  [[nodiscard]] std::int16_t* Row(int y) { return pixels.data() + (y + kPad) * Stride() + kPad; }
  // Bilinear, of the nearest place inside. Finite coordinates.
  [[nodiscard]] float Between(const Eigen::Vector2f& at_px) const;
  // Pixel centres are at whole numbers, so a scale moves them by half a pixel of either grid.
  [[nodiscard]] Eigen::Vector2d InPicture(const Eigen::Vector2f& at_px) const {
    return ((at_px.cast<double>().array() + 0.5) / scale - 0.5).matrix();
  }
};

// The picture itself at scale 1; its border is repeated into the padding.
[[nodiscard]] GreyLevel LevelOf(const GreyImage& image);
// Means of 2 x 2 pixels; an odd last row or column is left out.
[[nodiscard]] GreyLevel Halved(const GreyLevel& level);
// Bilinear. For pictures in which the squares may be tiny.
[[nodiscard]] GreyLevel Doubled(const GreyImage& image);

}  // namespace rigcal::detect
