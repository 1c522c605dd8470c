#include "server/detect/corners.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <opencv2/calib3d.hpp>
#include <opencv2/imgproc.hpp>

namespace rigcal::detect {
namespace {

using Points = std::vector<cv::Point2f>;

// The search is about squares of some tens of pixels: very large pictures are searched reduced, and those in which the
// squares may be tiny are searched enlarged.
constexpr int kSearchSidePx = 1600;
constexpr int kFullSearchSidePx = 4000;
constexpr int kEnlargeSidePx = 1400;
// Half window of the refinement as a part of the distance to the nearest corner: of 0.16 ... 0.34 the one that stays
// clear of the next corners on tilted boards; on real pairs the joint rms is 0.196 px, against 0.284 px for the
// sector-based search.
constexpr double kWindowRatio = 0.25;
constexpr int kWindowMinPx = 2, kWindowMaxPx = 20;

std::vector<double> SearchScales(const cv::Mat& image) {
  const int side = std::max(image.cols, image.rows);
  std::vector<double> scales;
  if (side > kSearchSidePx) scales.push_back(static_cast<double>(kSearchSidePx) / side);
  if (side <= kFullSearchSidePx) scales.push_back(1.0);
  if (side <= kEnlargeSidePx) scales.push_back(2.0);
  return scales;
}

cv::Mat Scaled(const cv::Mat& image, double scale) {
  if (scale == 1.0) return image;
  cv::Mat scaled;
  cv::resize(image, scaled, {}, scale, scale, scale < 1.0 ? cv::INTER_AREA : cv::INTER_LINEAR);
  return scaled;
}

// Pixel centres are at whole numbers, so a scale moves them by half a pixel of either grid.
void Unscale(Points& points, double scale) {
  for (cv::Point2f& point : points) {
    point.x = static_cast<float>((point.x + 0.5) / scale - 0.5);
    point.y = static_cast<float>((point.y + 0.5) / scale - 0.5);
  }
}

bool SearchByQuads(const cv::Mat& image, const cv::Size& counts, Points& points) {
  return cv::findChessboardCorners(image, counts, points, cv::CALIB_CB_ADAPTIVE_THRESH | cv::CALIB_CB_NORMALIZE_IMAGE);
}

bool SearchBySectors(const cv::Mat& image, const cv::Size& counts, Points& points) {
  return cv::findChessboardCornersSB(image, counts, points, cv::CALIB_CB_NORMALIZE_IMAGE | cv::CALIB_CB_EXHAUSTIVE);
}

bool Search(const cv::Mat& image, const cv::Size& counts, Points& points) {
  for (const auto search : {SearchByQuads, SearchBySectors}) {
    for (const double scale : SearchScales(image)) {
      if (!search(Scaled(image, scale), counts, points)) continue;
      Unscale(points, scale);
      return true;
    }
  }
  return false;
}

double NearestNeighbourPx(const Points& points, const cv::Size& counts, int corner_idx) {
  const int row = corner_idx / counts.width, col = corner_idx % counts.width;
  double nearest = HUGE_VAL;
  const auto consider = [&](int other_row, int other_col) {
    if (other_row < 0 || other_row >= counts.height || other_col < 0 || other_col >= counts.width) return;
    const auto other = static_cast<std::size_t>(other_row * counts.width + other_col);
    nearest = std::min(nearest, cv::norm(points[static_cast<std::size_t>(corner_idx)] - points[other]));
  };
  consider(row - 1, col);
  consider(row + 1, col);
  consider(row, col - 1);
  consider(row, col + 1);
  return nearest;
}

Points Refined(const cv::Mat& image, const cv::Size& counts, const Points& points) {
  const cv::TermCriteria until(cv::TermCriteria::EPS | cv::TermCriteria::COUNT, 100, 1e-4);
  Points refined = points;
  for (int i = 0; i < counts.area(); ++i) {
    const double spacing_px = NearestNeighbourPx(points, counts, i);
    const int window = std::clamp(static_cast<int>(std::lround(kWindowRatio * spacing_px)), kWindowMinPx, kWindowMaxPx);
    Points one = {points[static_cast<std::size_t>(i)]};
    cv::cornerSubPix(image, one, {window, window}, {-1, -1}, until);
    refined[static_cast<std::size_t>(i)] = one.front();
  }
  return refined;
}

}  // namespace

std::optional<std::vector<Eigen::Vector2d>> FindCorners(const GreyImage& image, int cols, int rows) {
  // OpenCV only reads, yet its wrapper for memory takes a mutable pointer.
  const cv::Mat grey(image.height_px, image.width_px, CV_8U, const_cast<std::uint8_t*>(image.pixels.data()));
  const cv::Size counts(cols, rows);
  Points points;
  if (!Search(grey, counts, points)) return std::nullopt;
  std::vector<Eigen::Vector2d> corners;
  for (const cv::Point2f& point : Refined(grey, counts, points)) corners.emplace_back(point.x, point.y);
  return corners;
}

}  // namespace rigcal::detect
