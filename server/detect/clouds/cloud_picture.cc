#include "server/detect/clouds/cloud_picture.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

namespace rigcal::detect {
namespace {

constexpr int kWidth_px = 1280, kHeightMin_px = 200, kHeightMax_px = 560, kBarHeight_px = 34;
constexpr int kColumns = 640, kRowsMax = 256;  // of the raster that beams fall into, before it is enlarged
constexpr int kJpegQuality = 88;
constexpr int kSubPixelBits = 4;
constexpr double kStretchMax = 3.0;  // of elevation against azimuth
const cv::Scalar kDark(28, 24, 22), kSignal(60, 220, 90), kOther(60, 170, 255), kText(215, 215, 215);

// Where a direction goes in the picture. Azimuth grows to the left, as the sensor sees it. A sensor that looks along z
// (as a depth camera does) is turned to look along x.
struct Projection {
  bool along_z = false;
  double middle_rad = 0, span_rad = 2 * M_PI, bottom_rad = 0, height_rad = 1;
  int width_px = kWidth_px, height_px = kHeightMin_px;

  // Azimuth and elevation.
  [[nodiscard]] Eigen::Vector2d Angles(const Eigen::Vector3d& point) const {
    const Eigen::Vector3d p = along_z ? Eigen::Vector3d(point.z(), -point.x(), -point.y()) : point;
    return {std::atan2(p.y(), p.x()), std::atan2(p.z(), p.head<2>().norm())};
  }
  // Shares of width (from the left) and height (from the top).
  [[nodiscard]] Eigen::Vector2d Share(const Eigen::Vector2d& angles_rad) const {
    return {0.5 - std::remainder(angles_rad.x() - middle_rad, 2 * M_PI) / span_rad,
            1 - (angles_rad.y() - bottom_rad) / height_rad};
  }
};

// Azimuth and elevation of each ray.
using Angles = std::vector<Eigen::Vector2d>;

// The middle of the narrowest stretch of azimuth that holds all points, and its width.
void FindSpan(const Angles& angles, Projection& projection) {
  constexpr int kBins = 360;
  std::vector<bool> occupied(kBins, false);
  for (const Eigen::Vector2d& at : angles) {
    const double share = at.x() / (2 * M_PI) + 0.5;
    occupied[static_cast<std::size_t>(std::clamp(static_cast<int>(share * kBins), 0, kBins - 1))] = true;
  }
  int gap = 0, longest = 0, end = 0;
  for (int i = 0; i < 2 * kBins; ++i) {
    gap = occupied[static_cast<std::size_t>(i % kBins)] ? 0 : gap + 1;
    if (gap > longest && gap <= kBins) longest = gap, end = i;
  }
  if (longest < 45 || longest >= kBins) return;  // all round
  projection.span_rad = (kBins - longest + 4) * 2 * M_PI / kBins;
  projection.middle_rad = std::remainder(((end + 1 + (kBins - longest) / 2.0) / kBins - 0.5) * 2 * M_PI, 2 * M_PI);
}

bool LooksAlongZ(const CloudRays& rays) {
  Eigen::Vector3f mean = Eigen::Vector3f::Zero();
  for (const Eigen::Vector3f& d : rays.directions) mean += d / static_cast<float>(rays.directions.size());
  return std::abs(mean.z()) > 0.8f;
}

void FindSize(const Angles& angles, Projection& projection) {
  double top = -M_PI, bottom = M_PI;
  for (const Eigen::Vector2d& at : angles) top = std::max(top, at.y()), bottom = std::min(bottom, at.y());
  const double border = 0.02 + 0.03 * (top - bottom);
  projection.bottom_rad = bottom - border, projection.height_rad = top - bottom + 2 * border;
  const double even_px = kWidth_px * projection.height_rad / projection.span_rad;
  projection.height_px =
      static_cast<int>(std::clamp(kStretchMax * even_px, 1.0 * kHeightMin_px, std::max(even_px, 380.0)));
  projection.height_px = std::min(projection.height_px, kHeightMax_px);
  projection.width_px = std::min<int>(kWidth_px, static_cast<int>(2.5 * projection.height_px / even_px * kWidth_px));
}

// Nearest range of each cell; 0: no beam.
cv::Mat1f Raster(const CloudRays& rays, const Angles& angles, const Projection& projection, int rows) {
  cv::Mat1f nearest(rows, kColumns, 0.0f);
  for (std::size_t i = 0; i < rays.points_m.size(); ++i) {
    const Eigen::Vector2d share = projection.Share(angles[i]);
    const int x = static_cast<int>(std::floor(share.x() * kColumns)),
              y = static_cast<int>(std::floor(share.y() * rows));
    if (x < 0 || x >= kColumns || y < 0 || y >= rows) continue;
    float& cell = nearest(y, x);
    const float range_m = rays.points_m[i].norm();
    if (cell == 0.0f || range_m < cell) cell = range_m;
  }
  return nearest;
}

// The usual gap between beams in a column, rows.
int RowGap(const cv::Mat1f& nearest) {
  std::vector<int> gaps;
  for (int x = 0; x < nearest.cols; ++x)
    for (int y = 0, last = -1; y < nearest.rows; ++y)
      if (nearest(y, x) > 0) {
        if (last >= 0) gaps.push_back(y - last);
        last = y;
      }
  if (gaps.empty()) return 1;
  const auto usual = gaps.begin() + static_cast<std::ptrdiff_t>(gaps.size() * 3 / 4);
  std::nth_element(gaps.begin(), usual, gaps.end());
  return *usual;
}

// Each empty cell takes the nearest beam of its column, half the usual gap away at most.
cv::Mat1f Filled(const cv::Mat1f& nearest) {
  const int reach = RowGap(nearest) / 2 + 1;
  cv::Mat1f filled = nearest.clone();
  for (int x = 0; x < nearest.cols; ++x)
    for (int y = 0; y < nearest.rows; ++y)
      for (int off = 1; off <= reach && filled(y, x) == 0.0f; ++off)
        for (const int other : {y - off, y + off})
          if (other >= 0 && other < nearest.rows && nearest(other, x) > 0 && filled(y, x) == 0.0f)
            filled(y, x) = nearest(other, x);
  return filled;
}

// Of 256 steps of log range, near to far: bright to dim, bluish.
std::array<cv::Vec3b, 256> Colours() {
  std::array<cv::Vec3b, 256> colours;
  for (std::size_t i = 0; i < colours.size(); ++i) {
    const float light = std::pow(1 - static_cast<float>(i) / 255, 1.3f);
    colours[i] = {cv::saturate_cast<std::uint8_t>(70 + 150 * light), cv::saturate_cast<std::uint8_t>(46 + 190 * light),
                  cv::saturate_cast<std::uint8_t>(34 + 205 * light)};
  }
  return colours;
}

// From the nearest to the farthest few of a hundred.
cv::Mat Coloured(const cv::Mat1f& range_m) {
  cv::Mat1f log_range;
  cv::log(cv::max(range_m, 1e-3f), log_range);
  std::vector<float> all;
  for (int y = 0; y < range_m.rows; ++y)
    for (int x = 0; x < range_m.cols; ++x)
      if (range_m(y, x) > 0) all.push_back(log_range(y, x));
  cv::Mat picture(range_m.size(), CV_8UC3, kDark);
  if (all.empty()) return picture;
  const auto few = static_cast<std::ptrdiff_t>(all.size() / 50);
  std::nth_element(all.begin(), all.begin() + few, all.end());
  const float near = all[static_cast<std::size_t>(few)];
  std::nth_element(all.begin(), all.end() - 1 - few, all.end());
  const float span = std::max(*(all.end() - 1 - few) - near, 0.1f);
  const auto colours = Colours();
  for (int y = 0; y < range_m.rows; ++y)
    for (int x = 0; x < range_m.cols; ++x)
      if (range_m(y, x) > 0)
        picture.at<cv::Vec3b>(y, x) =
            colours[static_cast<std::size_t>(std::clamp((log_range(y, x) - near) / span, 0.0f, 1.0f) * 255)];
  return picture;
}

void DrawPlate(cv::Mat& picture, const Projection& projection, const FittedPlate& plate, int number) {
  const cv::Scalar colour = number == 1 ? kSignal : kOther;
  const auto corners = plate.Corners_m();
  const double across = projection.Share(projection.Angles(plate.Centre_m())).x();
  constexpr int kSteps = 12;
  std::vector<cv::Point> line;
  Eigen::Vector2d top(0, 1e9);
  for (std::size_t side = 0; side < 4; ++side)
    for (int step = 0; step < kSteps; ++step) {
      const double share = static_cast<double>(step) / kSteps;
      Eigen::Vector2d at =
          projection.Share(projection.Angles(corners[side] * (1 - share) + corners[(side + 1) % 4] * share));
      if (projection.span_rad > 6.0) at.x() = across + std::remainder(at.x() - across, 2 * M_PI / projection.span_rad);
      const Eigen::Vector2d px(at.x() * picture.cols, at.y() * (picture.rows - kBarHeight_px));
      if (px.y() < top.y()) top = px;
      line.emplace_back(static_cast<int>(std::lround(px.x() * (1 << kSubPixelBits))),
                        static_cast<int>(std::lround(px.y() * (1 << kSubPixelBits))));
    }
  cv::polylines(picture, line, true, cv::Scalar::all(0), number == 1 ? 5 : 4, cv::LINE_AA, kSubPixelBits);
  cv::polylines(picture, line, true, colour, number == 1 ? 3 : 2, cv::LINE_AA, kSubPixelBits);
  const cv::Point place(std::clamp(static_cast<int>(top.x()) - 7, 2, picture.cols - 20),
                        std::clamp(static_cast<int>(top.y()) - 7, 20, picture.rows - kBarHeight_px - 4));
  cv::putText(picture, std::to_string(number), place, cv::FONT_HERSHEY_SIMPLEX, 0.7, cv::Scalar::all(0), 5,
              cv::LINE_AA);
  cv::putText(picture, std::to_string(number), place, cv::FONT_HERSHEY_SIMPLEX, 0.7, colour, 2, cv::LINE_AA);
}

std::string Caption(std::size_t points, const std::vector<FittedPlate>& plates) {
  if (plates.empty()) return std::to_string(points) + " points, no plate found";
  char text[160];
  std::snprintf(text, sizeof text, "%zu points, %zu candidate%s; no. 1 at %.2f m, score %.2f", points, plates.size(),
                plates.size() == 1 ? "" : "s", plates.front().Centre_m().norm(), plates.front().score);
  return text;
}

}  // namespace

std::string CloudPicture(const CloudRays& rays, std::size_t points, const std::vector<FittedPlate>& plates) {
  Projection projection;
  projection.along_z = LooksAlongZ(rays);
  Angles angles;
  for (const Eigen::Vector3f& d : rays.directions) angles.push_back(projection.Angles(d.cast<double>()));
  FindSpan(angles, projection);
  if (!angles.empty()) FindSize(angles, projection);
  cv::Mat picture(projection.height_px + kBarHeight_px, projection.width_px, CV_8UC3, kDark), scene;
  const cv::Mat1f nearest = Raster(rays, angles, projection, std::min(projection.height_px, kRowsMax));
  cv::resize(Coloured(Filled(nearest)), scene, {projection.width_px, projection.height_px}, 0, 0, cv::INTER_NEAREST);
  scene.copyTo(picture.rowRange(0, projection.height_px));
  for (std::size_t i = plates.size(); i > 0; --i) DrawPlate(picture, projection, plates[i - 1], static_cast<int>(i));
  cv::rectangle(picture, {0, projection.height_px, projection.width_px, kBarHeight_px}, kDark, -1);
  cv::putText(picture, Caption(points, plates), {10, picture.rows - 11}, cv::FONT_HERSHEY_SIMPLEX, 0.55, kText, 1,
              cv::LINE_AA);
  std::vector<std::uint8_t> jpeg;
  cv::imencode(".jpg", picture, jpeg, {cv::IMWRITE_JPEG_QUALITY, kJpegQuality});
  return std::string(jpeg.begin(), jpeg.end());
}

}  // namespace rigcal::detect
