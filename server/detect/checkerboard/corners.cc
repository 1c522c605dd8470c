#include "server/detect/checkerboard/corners.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <opencv2/imgproc.hpp>

#include "server/detect/checkerboard/board_search.h"
#include "server/detect/checkerboard/corner_refine.h"
#include "server/detect/checkerboard/part_search.h"

namespace rigcal::detect {
namespace {

using Points = std::vector<cv::Point2f>;

constexpr double kMoveRatio = 0.2, kMoveMin_px = 2;  // by the refinement, of the distance to the nearest corner
// Half window of the refinement as a part of the distance to the nearest corner: of 0.16 ... 0.34 the one that stays
// clear of the next corners on tilted boards; on real pairs the joint rms is 0.190 px, against 0.284 px for the
// sector-based search.
constexpr double kWindowRatio = 0.25;
constexpr int kWindowMinPx = 2, kWindowMaxPx = 20;

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

GridPart GridOf(const Points& points, const cv::Size& counts) {
  GridPart grid{{HUGE_VAL, HUGE_VAL}, {-HUGE_VAL, -HUGE_VAL}, 0, points.size()};
  for (int i = 0; i < counts.area(); ++i) {
    const Eigen::Vector2d at_px(points[static_cast<std::size_t>(i)].x, points[static_cast<std::size_t>(i)].y);
    grid.min_px = grid.min_px.cwiseMin(at_px), grid.max_px = grid.max_px.cwiseMax(at_px);
    grid.square_px += NearestNeighbourPx(points, counts, i) / counts.area();
  }
  return grid;
}

// OpenCV only reads, yet its wrapper for memory takes a mutable pointer.
cv::Mat Wrapped(const GreyImage& image) {
  return {image.height_px, image.width_px, CV_8U, const_cast<std::uint8_t*>(image.pixels.data())};
}

// The quick search first; where it saw a part of a board only, the thorough one around that part. That one would take a
// piece of a larger pattern for a board.
std::vector<Eigen::Vector2d> Search(const GreyImage& image, const cv::Size& counts) {
  const BoardSearch quick = SearchBoard(image, counts.width, counts.height);
  if (!quick.corners_px.empty() || quick.parts.empty()) return quick.corners_px;
  const Points points = SearchAround(Wrapped(image), quick.parts.front(), counts);
  if (points.empty()) return {};
  const GridPart grid = GridOf(points, counts);
  if (std::any_of(quick.others.begin(), quick.others.end(),
                  [&](const GridPart& other) { return IsPartOf(grid, other); }))
    return {};
  std::vector<Eigen::Vector2d> corners;
  for (const cv::Point2f& point : points) corners.emplace_back(point.x, point.y);
  return corners;
}

// Where blur and noise are too much for the refinement, it runs away from corners that were found.
bool Stayed(const std::vector<Eigen::Vector2d>& found, const std::vector<Eigen::Vector2d>& refined,
            const cv::Size& counts) {
  Points points;
  for (const Eigen::Vector2d& corner : found)
    points.emplace_back(static_cast<float>(corner.x()), static_cast<float>(corner.y()));
  for (int i = 0; i < counts.area(); ++i) {
    const auto idx = static_cast<std::size_t>(i);
    const double move_max_px = std::max(kMoveMin_px, kMoveRatio * NearestNeighbourPx(points, counts, i));
    if (!((refined[idx] - found[idx]).norm() <= move_max_px)) return false;
  }
  return true;
}

}  // namespace

std::vector<Eigen::Vector2d> RefinedCorners(const GreyImage& image, int cols, int rows,
                                            const std::vector<Eigen::Vector2d>& corners) {
  Points points;
  for (const Eigen::Vector2d& corner : corners)
    points.emplace_back(static_cast<float>(corner.x()), static_cast<float>(corner.y()));
  std::vector<Eigen::Vector2d> refined;
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const double spacing_px = NearestNeighbourPx(points, {cols, rows}, static_cast<int>(i));
    const int window = std::clamp(static_cast<int>(std::lround(kWindowRatio * spacing_px)), kWindowMinPx, kWindowMaxPx);
    refined.push_back(EdgesMeet(image, corners[i], window));
  }
  return refined;
}

std::optional<std::vector<Eigen::Vector2d>> FindCorners(const GreyImage& image, int cols, int rows) {
  const auto found = Search(image, {cols, rows});
  if (found.empty()) return std::nullopt;
  auto refined = RefinedCorners(image, cols, rows, found);
  if (!Stayed(found, refined, {cols, rows})) return std::nullopt;
  return refined;
}

}  // namespace rigcal::detect
