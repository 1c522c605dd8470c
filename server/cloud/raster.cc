#include "server/cloud/raster.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <opencv2/imgproc.hpp>

namespace rigcal::cloud {

Raster::Raster(int width_px, int height_px)
    : depth_(height_px, width_px, std::numeric_limits<float>::infinity()),
      bgr_(height_px, width_px, cv::Vec3b(0, 0, 0)) {}

void Raster::Disc(const Eigen::Vector3f& place, float radius_px, const Rgb& rgb) {
  const int x0 = std::max(0, static_cast<int>(std::lround(place.x() - radius_px)));
  const int x1 = std::min(bgr_.cols - 1, static_cast<int>(std::lround(place.x() + radius_px)));
  const int y0 = std::max(0, static_cast<int>(std::lround(place.y() - radius_px)));
  const int y1 = std::min(bgr_.rows - 1, static_cast<int>(std::lround(place.y() + radius_px)));
  const cv::Vec3b bgr(rgb[2], rgb[1], rgb[0]);
  for (int y = y0; y <= y1; ++y)
    for (int x = x0; x <= x1; ++x) {
      const float dx = static_cast<float>(x) - place.x(), dy = static_cast<float>(y) - place.y();
      if (dx * dx + dy * dy > radius_px * radius_px + 0.3F || !(place.z() < depth_(y, x))) continue;
      depth_(y, x) = place.z(), bgr_(y, x) = bgr;
    }
}

void Raster::ShadeEdges(float unit_m, int reach_px) {
  const std::array<cv::Point, 8> around = {{{1, 0}, {-1, 0}, {0, 1}, {0, -1}, {1, 1}, {-1, 1}, {1, -1}, {-1, -1}}};
  for (int y = 0; y < bgr_.rows; ++y)
    for (int x = 0; x < bgr_.cols; ++x) {
      const float own = depth_(y, x);
      if (!std::isfinite(own)) continue;
      float behind = 0;
      for (const cv::Point& step : around) {
        const int nx = std::clamp(x + reach_px * step.x, 0, bgr_.cols - 1);
        const int ny = std::clamp(y + reach_px * step.y, 0, bgr_.rows - 1);
        behind += std::clamp(own - depth_(ny, nx), 0.0F, unit_m) / 8;  // background in front of nothing: minus infinity
      }
      const float light = std::exp2(-behind / unit_m * 1.6F);
      for (int c = 0; c < 3; ++c)
        bgr_(y, x)[c] = static_cast<std::uint8_t>(static_cast<float>(bgr_(y, x)[c]) * light + 0.5F);
    }
}

cv::Mat Raster::Halved(const cv::Scalar& top, const cv::Scalar& bottom) const {
  cv::Mat3b filled = bgr_.clone();
  for (int y = 0; y < filled.rows; ++y) {
    const double share = static_cast<double>(y) / filled.rows;
    cv::Vec3b colour;
    for (int c = 0; c < 3; ++c) colour[c] = cv::saturate_cast<std::uint8_t>(top[c] + share * (bottom[c] - top[c]));
    for (int x = 0; x < filled.cols; ++x)
      if (!std::isfinite(depth_(y, x))) filled(y, x) = colour;
  }
  cv::Mat half;
  cv::resize(filled, half, {filled.cols / 2, filled.rows / 2}, 0, 0, cv::INTER_AREA);
  return half;
}

}  // namespace rigcal::cloud
