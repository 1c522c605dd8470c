#include "server/detect/circles/blobs.h"

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <map>
#include <opencv2/imgproc.hpp>
#include <optional>
#include <utility>

namespace rigcal::detect {
namespace {

// Windows over which the grey that parts a spot from its surroundings is taken, over the picture's shorter side: any
// that is larger than a spot and smaller than what light changes over will do, and of one that is smaller the rim of a
// spot remains, which has the same outline.
constexpr std::array<double, 3> kWindows = {0.03, 0.08, 0.25};
constexpr int kWindowMin_px = 11;
constexpr double kContrastMin_grey = 6;
constexpr double kMinorMin_px = 1.8, kAxesRatioMax = 5;  // a board that is tilted by 78 degrees
// Of the outline from the ellipse, over its axes: of the shape, and of whole pixels.
constexpr double kRoundness_ratio = 0.1, kPixel_px = 0.75;
constexpr double kAreaTolerance = 0.2;

struct Spot {
  Ellipse ellipse;
  double off_round = 0.0;  // the largest distance of the outline from the ellipse, of its radius
};

std::vector<Eigen::Vector2d> OutlineOf(const std::vector<cv::Point>& contour) {
  std::vector<Eigen::Vector2d> outline;
  for (const cv::Point& point : contour) outline.emplace_back(point.x, point.y);
  return outline;
}

// Contours run through the middle of the outermost pixels: half a pixel is missing all round.
Eigen::Matrix2d Widened(const Eigen::Matrix2d& axes_px) { return axes_px + 0.5 * Eigen::Matrix2d::Identity(); }

bool IsRound(const std::vector<Eigen::Vector2d>& outline, Spot& spot) {
  const double allowed = kRoundness_ratio + kPixel_px / spot.ellipse.Minor_px();
  for (const Eigen::Vector2d& at_px : outline) {
    spot.off_round = std::max(spot.off_round, std::abs(spot.ellipse.Whitened(at_px).norm() - 1));
    if (spot.off_round > allowed) return false;
  }
  return true;
}

// Of a narrow window the ring around a spot is one, too, of the other shade; and so is a hole.
bool IsOfItsShade(const cv::Mat& grey, const Ellipse& ellipse) {
  constexpr int kAround = 8;
  const auto at = [&](const Eigen::Vector2d& place) {
    const int x = std::clamp(static_cast<int>(std::lround(place.x())), 0, grey.cols - 1);
    const int y = std::clamp(static_cast<int>(std::lround(place.y())), 0, grey.rows - 1);
    return static_cast<double>(grey.at<std::uint8_t>(y, x));
  };
  double outside = 0;
  for (int i = 0; i < kAround; ++i) {
    const double angle = 2 * M_PI * i / kAround;
    outside += at(ellipse.centre_px + 1.25 * ellipse.axes_px * Eigen::Vector2d(std::cos(angle), std::sin(angle)));
  }
  const double rise = outside / kAround - at(ellipse.centre_px);
  return (ellipse.is_dark ? rise : -rise) >= kContrastMin_grey;
}

std::optional<Spot> SpotOf(const std::vector<cv::Point>& contour, const cv::Size& picture, bool is_dark) {
  if (contour.size() < 8) return std::nullopt;
  const cv::Rect box = cv::boundingRect(contour);
  if (box.x <= 1 || box.y <= 1 || box.br().x >= picture.width - 1 || box.br().y >= picture.height - 1)
    return std::nullopt;
  // No more points than its box has around it, or it goes back and forth.
  if (contour.size() > 2 * static_cast<std::size_t>(box.width + box.height)) return std::nullopt;
  const std::vector<Eigen::Vector2d> outline = OutlineOf(contour);
  const PolygonMoments moments = MomentsOf(outline);
  if (!(moments.area > 0)) return std::nullopt;
  const Eigen::Matrix2d axes_px = AxesOf(moments.second);
  const double round_area = M_PI * axes_px.determinant();
  if (!(std::abs(moments.area - round_area) <= kAreaTolerance * round_area)) return std::nullopt;
  Spot spot{{moments.centroid, Widened(axes_px), is_dark}, 0.0};
  if (!(spot.ellipse.Minor_px() >= kMinorMin_px && spot.ellipse.Major_px() <= kAxesRatioMax * spot.ellipse.Minor_px()))
    return std::nullopt;
  if (!IsRound(outline, spot)) return std::nullopt;
  return spot;
}

void AddSpots(const cv::Mat& grey, int window_px, bool is_dark, std::vector<Spot>& spots) {
  cv::Mat mask;
  cv::adaptiveThreshold(grey, mask, 255, cv::ADAPTIVE_THRESH_MEAN_C,
                        is_dark ? cv::THRESH_BINARY_INV : cv::THRESH_BINARY, window_px,
                        is_dark ? kContrastMin_grey : -kContrastMin_grey);
  std::vector<std::vector<cv::Point>> contours;
  // Without their hierarchy: to tell it takes the square of their number.
  cv::findContours(mask, contours, cv::RETR_LIST, cv::CHAIN_APPROX_NONE);
  for (const std::vector<cv::Point>& contour : contours)
    if (auto spot = SpotOf(contour, grey.size(), is_dark); spot && IsOfItsShade(grey, spot->ellipse))
      spots.push_back(*spot);
}

constexpr double kCell_px = 8;

// Found twice. (The whole board may be a spot in the middle of which one of its circles lies.)
bool IsSameSpot(const Ellipse& a, const Ellipse& b) {
  const double size = std::sqrt(a.axes_px.determinant() / b.axes_px.determinant());
  return size > 0.6 && size < 1.7 && (a.centre_px - b.centre_px).norm() < std::min(kCell_px, 0.5 * b.Minor_px());
}

std::pair<double, double> RowsFirst(const Spot& spot) {
  return {spot.ellipse.centre_px.y(), spot.ellipse.centre_px.x()};
}

// Of spots that were found twice the rounder one.
std::vector<Ellipse> OneOfEach(std::vector<Spot> spots) {
  std::sort(spots.begin(), spots.end(), [](const Spot& a, const Spot& b) {
    return std::pair(a.off_round, RowsFirst(a)) < std::pair(b.off_round, RowsFirst(b));
  });
  std::map<std::pair<int, int>, std::vector<Spot>> kept;
  const auto is_known = [&](const Spot& spot, int cell_x, int cell_y) {
    for (int i = 0; i < 9; ++i)
      for (const Spot& other : kept[{cell_x + i % 3 - 1, cell_y + i / 3 - 1}])
        if (IsSameSpot(spot.ellipse, other.ellipse)) return true;
    return false;
  };
  std::vector<Spot> all;
  for (const Spot& spot : spots) {
    const int cell_x = static_cast<int>(spot.ellipse.centre_px.x() / kCell_px);
    const int cell_y = static_cast<int>(spot.ellipse.centre_px.y() / kCell_px);
    if (is_known(spot, cell_x, cell_y)) continue;
    kept[{cell_x, cell_y}].push_back(spot);
    all.push_back(spot);
  }
  std::sort(all.begin(), all.end(), [](const Spot& a, const Spot& b) { return RowsFirst(a) < RowsFirst(b); });
  std::vector<Ellipse> ellipses;
  for (const Spot& spot : all) ellipses.push_back(spot.ellipse);
  return ellipses;
}

}  // namespace

Eigen::Vector2d Ellipse::Whitened(const Eigen::Vector2d& at_px) const {
  return axes_px.inverse() * (at_px - centre_px);
}

double Ellipse::Major_px() const {
  return axes_px.trace() / 2 + std::hypot((axes_px(0, 0) - axes_px(1, 1)) / 2, axes_px(0, 1));
}

double Ellipse::Minor_px() const {
  return axes_px.trace() / 2 - std::hypot((axes_px(0, 0) - axes_px(1, 1)) / 2, axes_px(0, 1));
}

PolygonMoments MomentsOf(const std::vector<Eigen::Vector2d>& polygon) {
  PolygonMoments moments;
  if (polygon.empty()) return moments;
  const Eigen::Vector2d origin = polygon.front();
  double doubled = 0;
  Eigen::Vector2d first = Eigen::Vector2d::Zero();
  Eigen::Matrix2d second = Eigen::Matrix2d::Zero();
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const Eigen::Vector2d a = polygon[i] - origin, b = polygon[(i + 1) % polygon.size()] - origin, sum = a + b;
    const double cross = a.x() * b.y() - a.y() * b.x();
    doubled += cross;
    first += cross * sum;
    second += cross * (a * a.transpose() + b * b.transpose() + sum * sum.transpose());
  }
  if (doubled == 0) return moments;
  moments.area = std::abs(doubled) / 2;
  const Eigen::Vector2d middle = first / (3 * doubled);
  moments.centroid = origin + middle;
  moments.second = second / (12 * doubled) - middle * middle.transpose();
  return moments;
}

Eigen::Matrix2d AxesOf(const Eigen::Matrix2d& second_moments) {
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> eigen(second_moments);
  if (!(eigen.eigenvalues()[0] > 0)) return Eigen::Matrix2d::Zero();
  return 2 * eigen.operatorSqrt();
}

std::vector<Ellipse> FindEllipses(const GreyImage& image) {
  // OpenCV only reads, yet its wrapper for memory takes a mutable pointer.
  const cv::Mat picture(image.height_px, image.width_px, CV_8U, const_cast<std::uint8_t*>(image.pixels.data()));
  cv::Mat grey;
  cv::GaussianBlur(picture, grey, {3, 3}, 0.8);
  std::vector<Spot> spots;
  for (const double window : kWindows) {
    const int half_px = static_cast<int>(window * std::min(image.width_px, image.height_px) / 2);
    const int window_px = std::max(kWindowMin_px, 2 * half_px + 1);
    for (const bool is_dark : {true, false}) AddSpots(grey, window_px, is_dark, spots);
  }
  return OneOfEach(std::move(spots));
}

}  // namespace rigcal::detect
