#include "server/detect/marker_code.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "server/detect/plane_map.h"

namespace rigcal::detect {
namespace {

constexpr double kContrastMin = 12;         // grey levels between dark and light cells
constexpr double kBorderBrokenRatio = 0.1;  // cells of the border that may have the other colour
constexpr double kCorrectionRate = 0.6;     // of what the dictionary can correct

double GreyAt(const cv::Mat& grey, const Eigen::Vector2d& at_px) {
  const double x = std::clamp(at_px.x(), 0.0, grey.cols - 1.0), y = std::clamp(at_px.y(), 0.0, grey.rows - 1.0);
  const int x0 = static_cast<int>(x), y0 = static_cast<int>(y);
  const int x1 = std::min(x0 + 1, grey.cols - 1), y1 = std::min(y0 + 1, grey.rows - 1);
  const double fx = x - x0, fy = y - y0;
  return (1 - fy) * ((1 - fx) * grey.at<std::uint8_t>(y0, x0) + fx * grey.at<std::uint8_t>(y0, x1)) +
         fy * ((1 - fx) * grey.at<std::uint8_t>(y1, x0) + fx * grey.at<std::uint8_t>(y1, x1));
}

// Mean grey of the middle of every cell, row by row. Empty if the corners are no square seen from anywhere.
std::vector<double> CellGreys(const cv::Mat& grey, const std::array<Eigen::Vector2d, 4>& corners_px, int cells) {
  const double side = cells;
  const auto map = PlaneMap::Fit({{0, 0}, {side, 0}, {side, side}, {0, side}}, {corners_px.begin(), corners_px.end()});
  std::vector<double> greys;
  for (int i = 0; map && i < cells * cells; ++i) {
    double sum = 0;
    for (int k = 0; k < 9; ++k) {
      const Eigen::Vector2d within(0.5 + 0.2 * (k % 3 - 1), 0.5 + 0.2 * (k / 3 - 1));
      const auto pixel = map->Pixel(Eigen::Vector2d(i % cells, i / cells) + within);
      if (!pixel) return {};
      sum += GreyAt(grey, *pixel);
    }
    greys.push_back(sum / 9);
  }
  return greys;
}

// The level that parts the greys into two groups with the largest variance between them (Otsu). Negative: all alike.
double Level(std::vector<double> greys) {
  std::sort(greys.begin(), greys.end());
  double total = 0, below = 0, best = 0, level = -1;
  for (const double grey : greys) total += grey;
  for (std::size_t i = 1; i < greys.size(); ++i) {
    below += greys[i - 1];
    const double low = static_cast<double>(i), high = static_cast<double>(greys.size() - i);
    const double apart = (total - below) / high - below / low;
    if (apart < kContrastMin || low * high * apart * apart <= best) continue;
    best = low * high * apart * apart;
    level = (greys[i - 1] + greys[i]) / 2;
  }
  return level;
}

}  // namespace

std::optional<ReadMarker> ReadCode(const cv::Mat& grey, const std::array<Eigen::Vector2d, 4>& corners_px,
                                   const cv::aruco::Dictionary& dictionary, int border_bits) {
  const int cells = dictionary.markerSize + 2 * border_bits;
  const std::vector<double> greys = CellGreys(grey, corners_px, cells);
  const double level = greys.empty() ? -1 : Level(greys);
  if (level < 0) return std::nullopt;
  cv::Mat bits(dictionary.markerSize, dictionary.markerSize, CV_8U);
  int border = 0, light = 0;
  for (int i = 0; i < cells * cells; ++i) {
    const int row = i / cells - border_bits, col = i % cells - border_bits;
    const bool is_light = greys[static_cast<std::size_t>(i)] > level;
    if (row >= 0 && col >= 0 && row < bits.rows && col < bits.cols) {
      bits.at<std::uint8_t>(row, col) = is_light ? 1 : 0;
    } else {
      ++border;
      light += is_light ? 1 : 0;
    }
  }
  const double broken = kBorderBrokenRatio * border;
  if (light > broken && border - light > broken) return std::nullopt;
  if (light > broken) bits = 1 - bits;
  int id = -1, rotation = 0;
  if (!dictionary.identify(bits, id, rotation, kCorrectionRate)) return std::nullopt;
  ReadMarker marker{id, {}};
  for (std::size_t i = 0; i < 4; ++i)
    marker.corners_px[i] = corners_px[(i + 4 - static_cast<std::size_t>(rotation)) % 4];
  return marker;
}

}  // namespace rigcal::detect
