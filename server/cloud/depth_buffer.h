// Nearest range in each cell of a camera's picture.
#pragma once

#include <algorithm>
#include <limits>
#include <vector>

namespace rigcal::cloud {

// A patch in front of the camera: its middle and half sides, in cells.
struct Patch {
  float x = 0, y = 0, range_m = 0;
  float half_x = 0, half_y = 0;
};

class DepthBuffer {
 public:
  // Cells in which nothing has been seen yet.
  DepthBuffer(int width, int height)
      : width_(width),
        height_(height),
        nearest_m_(static_cast<std::size_t>(width) * static_cast<std::size_t>(height),
                   std::numeric_limits<float>::infinity()) {}

  // In cells.
  [[nodiscard]] int width() const { return width_; }
  [[nodiscard]] int height() const { return height_; }
  // Cells whose middle the patch covers, and always its own. Only rows first to last - 1: threads share by rows.
  void Splat(const Patch& patch, int first_row, int last_row) {
    const int own_x = static_cast<int>(patch.x), own_y = static_cast<int>(patch.y);
    const int x0 = std::max(0, std::min(own_x, Ceil(patch.x - patch.half_x - 0.5F)));
    const int x1 = std::min(width_ - 1, std::max(own_x, Floor(patch.x + patch.half_x - 0.5F)));
    const int y0 = std::max(first_row, std::min(own_y, Ceil(patch.y - patch.half_y - 0.5F)));
    const int y1 = std::min(last_row - 1, std::max(own_y, Floor(patch.y + patch.half_y - 0.5F)));
    for (int y = y0; y <= y1; ++y) {
      float* row = &nearest_m_[static_cast<std::size_t>(y) * static_cast<std::size_t>(width_)];
      for (int x = x0; x <= x1; ++x) row[x] = std::min(row[x], patch.range_m);
    }
  }
  // Of the cell that the place lies in.
  [[nodiscard]] const float& NearestAt(float x, float y) const {
    return nearest_m_[static_cast<std::size_t>(static_cast<int>(y)) * static_cast<std::size_t>(width_) +
                      static_cast<std::size_t>(static_cast<int>(x))];
  }

 private:
  static int Floor(float value) { return static_cast<int>(value + 65536.0F) - 65536; }
  static int Ceil(float value) { return -Floor(-value); }

  int width_, height_;
  std::vector<float> nearest_m_;
};

}  // namespace rigcal::cloud
