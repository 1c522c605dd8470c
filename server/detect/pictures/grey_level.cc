#include "server/detect/pictures/grey_level.h"

#include <algorithm>

namespace rigcal::detect {
namespace {

GreyLevel Sized(int width_px, int height_px, double scale) {
  GreyLevel level{width_px, height_px, scale, {}};
  level.pixels.resize(static_cast<std::size_t>(level.Stride() * (height_px + 2 * GreyLevel::kPad)));
  return level;
}

void RepeatBorder(GreyLevel& level) {
  for (int y = 0; y < level.height_px; ++y) {
    std::int16_t* row = level.Row(y);
    std::fill(row - GreyLevel::kPad, row, row[0]);
    std::fill(row + level.width_px, row + level.width_px + GreyLevel::kPad, row[level.width_px - 1]);
  }
  for (int y = 1; y <= GreyLevel::kPad; ++y) {
    const std::int16_t* first = level.Row(0) - GreyLevel::kPad;
    const std::int16_t* last = level.Row(level.height_px - 1) - GreyLevel::kPad;
    std::copy(first, first + level.Stride(), level.Row(-y) - GreyLevel::kPad);
    std::copy(last, last + level.Stride(), level.Row(level.height_px - 1 + y) - GreyLevel::kPad);
  }
}

}  // namespace

float GreyLevel::Between(const Eigen::Vector2f& at_px) const {
  const float x = std::clamp(at_px.x(), 0.0f, static_cast<float>(width_px - 1));
  const float y = std::clamp(at_px.y(), 0.0f, static_cast<float>(height_px - 1));
  const int x0 = static_cast<int>(x), y0 = static_cast<int>(y);
  const float fx = x - static_cast<float>(x0), fy = y - static_cast<float>(y0);
  const std::int16_t *above = Row(y0) + x0, *below = Row(y0 + 1) + x0;  // the padding holds the last ones
  return (1 - fy) * ((1 - fx) * above[0] + fx * above[1]) + fy * ((1 - fx) * below[0] + fx * below[1]);
}

GreyLevel LevelOf(const GreyImage& image) {
  GreyLevel level = Sized(image.width_px, image.height_px, 1.0);
  for (int y = 0; y < image.height_px; ++y) {
    const std::uint8_t* from = image.pixels.data() + static_cast<std::ptrdiff_t>(y) * image.width_px;
    std::copy(from, from + image.width_px, level.Row(y));
  }
  RepeatBorder(level);
  return level;
}

GreyLevel Halved(const GreyLevel& level) {
  GreyLevel half = Sized(level.width_px / 2, level.height_px / 2, level.scale / 2);
  for (int y = 0; y < half.height_px; ++y) {
    const std::int16_t *above = level.Row(2 * y), *below = level.Row(2 * y + 1);
    std::int16_t* row = half.Row(y);
    for (int x = 0; x < half.width_px; ++x)
      row[x] = static_cast<std::int16_t>((above[2 * x] + above[2 * x + 1] + below[2 * x] + below[2 * x + 1] + 2) >> 2);
  }
  RepeatBorder(half);
  return half;
}

GreyLevel Doubled(const GreyImage& image) {
  const GreyLevel level = LevelOf(image);
  GreyLevel twice = Sized(2 * image.width_px, 2 * image.height_px, 2.0);
  for (int y = 0; y < twice.height_px; ++y) {
    // A pixel's two halves lie a quarter of a pixel before and after its centre.
    const std::int16_t *near = level.Row(y / 2), *far = level.Row(y % 2 == 0 ? y / 2 - 1 : y / 2 + 1);
    std::int16_t* row = twice.Row(y);
    for (int x = 0; x < image.width_px; ++x) {
      const int before = 3 * near[x - 1] + far[x - 1], here = 3 * near[x] + far[x],
                after = 3 * near[x + 1] + far[x + 1];
      row[2 * x] = static_cast<std::int16_t>((3 * here + before + 8) >> 4);
      row[2 * x + 1] = static_cast<std::int16_t>((3 * here + after + 8) >> 4);
    }
  }
  RepeatBorder(twice);
  return twice;
}

}  // namespace rigcal::detect
