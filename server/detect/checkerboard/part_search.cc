#include "server/detect/checkerboard/part_search.h"

#include <algorithm>
#include <cmath>
#include <opencv2/calib3d.hpp>
#include <opencv2/imgproc.hpp>

namespace rigcal::detect {
namespace {

using Points = std::vector<cv::Point2f>;

constexpr double kMarginSquares = 2.5;
constexpr double kClearSquares = 1.25;  // beside a board, to see whether it goes on
constexpr double kEnlargedMax = 2.0;
// Sides of squares in the pictures that are searched once more. On boards with shadows, glare and motion blur, of which
// a part was seen, these find more than larger squares do and more than the sector-based search, in a tenth of the
// time.
constexpr double kQuickSquares_px[] = {9, 11, 13, 16};
// The search for quads takes 20 to 80 ms for so many pixels. Smaller squares are not worth it.
constexpr double kQuadSquares_px = 18, kQuadSquaresMin_px = 9, kQuadArea_px2 = 80'000;

// What a whole board may cover of which a part was seen; it may reach beyond the picture.
cv::Rect WholeOf(const GridPart& part, const cv::Size& counts) {
  const double whole_px = (std::max(counts.width, counts.height) + 1) * part.square_px;
  const Eigen::Array2d seen_px = part.max_px - part.min_px;
  const Eigen::Array2d margin_px = (whole_px - seen_px).max(kMarginSquares * part.square_px);
  const Eigen::Array2i first = (part.min_px.array() - margin_px).cast<int>();
  const Eigen::Array2i last = (part.max_px.array() + margin_px).cast<int>();
  return {first.x(), first.y(), last.x() - first.x(), last.y() - first.y()};
}

cv::Mat Scaled(const cv::Mat& image, double scale) {
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

bool SearchQuickly(const cv::Mat& image, const cv::Size& counts, Points& points) {
  GreyImage grey{image.cols, image.rows, {}};
  for (int y = 0; y < image.rows; ++y) grey.pixels.insert(grey.pixels.end(), image.ptr(y), image.ptr(y) + image.cols);
  points.clear();
  for (const Eigen::Vector2d& corner : SearchBoard(grey, counts.width, counts.height).corners_px)
    points.emplace_back(static_cast<float>(corner.x()), static_cast<float>(corner.y()));
  return !points.empty();
}

bool SearchByQuads(const cv::Mat& image, const cv::Size& counts, Points& points) {
  return cv::findChessboardCorners(image, counts, points, cv::CALIB_CB_ADAPTIVE_THRESH | cv::CALIB_CB_NORMALIZE_IMAGE);
}

// In `image`, in which the squares have `square_px`.
bool SearchIn(const cv::Mat& image, double square_px, const cv::Size& counts, Points& points) {
  const auto search = [&](double wanted_px, const auto& by) {
    const double scale = std::min(kEnlargedMax, wanted_px / square_px);
    if (!by(Scaled(image, scale), counts, points)) return false;
    Unscale(points, scale);
    return true;
  };
  for (const double wanted_px : kQuickSquares_px)
    if (search(wanted_px, SearchQuickly)) return true;
  const double area_squares = static_cast<double>(image.total()) / (square_px * square_px);
  const double wanted_px = std::min(kQuadSquares_px, std::sqrt(kQuadArea_px2 / area_squares));
  return wanted_px >= kQuadSquaresMin_px && search(wanted_px, SearchByQuads);
}

}  // namespace

std::vector<cv::Point2f> SearchAround(const cv::Mat& image, const GridPart& part, const cv::Size& counts) {
  const cv::Rect whole = WholeOf(part, counts);
  const cv::Rect around = whole & cv::Rect(0, 0, image.cols, image.rows);
  Points points;
  if (!SearchIn(image(around), part.square_px, counts, points)) return {};
  for (cv::Point2f& point : points) point += cv::Point2f(around.tl());
  // What reaches the edge of the part searched may be a piece of a larger pattern.
  const int clear_px = static_cast<int>(kClearSquares * part.square_px);
  const cv::Rect inner(whole.x + clear_px, whole.y + clear_px, whole.width - 2 * clear_px, whole.height - 2 * clear_px);
  if (!std::all_of(points.begin(), points.end(), [&](const cv::Point2f& point) { return inner.contains(point); }))
    return {};
  return points;
}

}  // namespace rigcal::detect
