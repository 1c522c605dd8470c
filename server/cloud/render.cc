#include "server/cloud/render.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "server/cloud/raster.h"

namespace rigcal::cloud {
namespace {

constexpr float kNearest_m = 0.3F;
constexpr float kDiscMin_px = 1.5F, kDiscMax_px = 26;  // radii, in the raster, which is twice as fine as the picture
// A disc fills its step of a dense scan; a sparse one stays lines of points, which show more than blots.
constexpr float kDiscPerStep = 0.9F, kDiscPerStepLeast = 0.35F, kDisc_rad = 0.0035F;
constexpr float kFacingAway = -0.12F;

struct Colours {
  cv::Scalar top, bottom, ink, shadow;
};
Colours ColoursOf(Background background) {
  if (background == Background::kLight) return {{250, 248, 246}, {232, 228, 224}, {50, 44, 40}, {255, 255, 255}};
  return {{66, 57, 52}, {44, 37, 33}, {240, 238, 235}, {0, 0, 0}};
}

// 1, 2 or 5 times a power of ten, at most this.
double RoundLength(double at_most_m) {
  const double power = std::pow(10.0, std::floor(std::log10(at_most_m)));
  const double digit = at_most_m / power;
  return power * (digit >= 5 ? 5 : digit >= 2 ? 2 : 1);
}

std::string LengthText(double length_m) {
  if (length_m >= 1) return std::to_string(std::lround(length_m)) + " m";
  return std::to_string(std::lround(100 * length_m)) + " cm";
}

void Write(const std::string& text, const cv::Point& at, const Colours& colours, cv::Mat& picture) {
  cv::putText(picture, text, at, cv::FONT_HERSHEY_SIMPLEX, 0.55, colours.shadow, 4, cv::LINE_AA);
  cv::putText(picture, text, at, cv::FONT_HERSHEY_SIMPLEX, 0.55, colours.ink, 1, cv::LINE_AA);
}

void DrawScale(const Viewpoint& view, const Colours& colours, cv::Mat& picture) {
  const double distance_m = view.perspective ? std::max(1L, std::lround(view.reach_m)) : 1.0;
  const double pixels_per_m = view.scale_px / (view.perspective ? distance_m : 1.0);
  const double length_m = RoundLength(0.2 * picture.cols / pixels_per_m);
  const int length_px = static_cast<int>(std::lround(length_m * pixels_per_m));
  const cv::Point left(24, picture.rows - 24), right(24 + length_px, picture.rows - 24);
  for (const auto& [colour, thickness] : {std::pair(colours.shadow, 5), std::pair(colours.ink, 2)}) {
    cv::line(picture, left, right, colour, thickness, cv::LINE_AA);
    for (const cv::Point& end : {left, right})
      cv::line(picture, end - cv::Point(0, 6), end + cv::Point(0, 6), colour, thickness, cv::LINE_AA);
  }
  const std::string at = view.perspective ? " at " + LengthText(distance_m) : "";
  Write(LengthText(length_m) + at, left - cv::Point(0, 13), colours, picture);
}

// Where the lidar stands.
void DrawLidar(const Viewpoint& view, const Colours& colours, cv::Mat& picture) {
  const Eigen::Vector3f place = view.Place(Eigen::Vector3f::Zero(), picture.cols, picture.rows);
  const cv::Point at(static_cast<int>(place.x()), static_cast<int>(place.y()));
  cv::circle(picture, at, 7, colours.shadow, 5, cv::LINE_AA);
  cv::circle(picture, at, 7, colours.ink, 2, cv::LINE_AA);
}

// What the picture is about: the points with colours, if there are some.
std::vector<Eigen::Vector3f> Subject(const ColouredCloud& cloud) {
  constexpr std::size_t kEnough = 300;
  if (cloud.covered < kEnough) return cloud.points_m;
  std::vector<Eigen::Vector3f> covered;
  for (std::size_t i = 0; i < cloud.points_m.size(); ++i)
    if (cloud.camera_idx[i] != kNoCamera) covered.push_back(cloud.points_m[i]);
  return covered;
}

Raster Splatted(const ColouredCloud& cloud, const Viewpoint& view, int width_px, int height_px) {
  Raster raster(width_px, height_px);
  const float disc_rad =
      std::max(kDiscPerStepLeast * cloud.step_rad, std::min(kDiscPerStep * cloud.step_rad, kDisc_rad));
  const Eigen::Vector3f into = view.R_view_lidar.row(2);
  for (std::size_t i = 0; i < cloud.points_m.size(); ++i) {
    const Eigen::Vector3f& point = cloud.points_m[i];
    const Eigen::Vector3f p_view = view.R_view_lidar * point;
    if (view.perspective ? p_view.z() < kNearest_m : cloud.facing.At(point).dot(-into) < kFacingAway) continue;
    const Eigen::Vector3f place = view.Place(p_view, width_px, height_px);
    const float radius_m = disc_rad * point.norm();
    const float radius_px =
        std::clamp(radius_m * view.scale_px / (view.perspective ? p_view.z() : 1), kDiscMin_px, kDiscMax_px);
    const bool outside = !(place.x() > -radius_px) || !(place.y() > -radius_px) ||
                         !(place.x() < static_cast<float>(width_px) + radius_px) ||
                         !(place.y() < static_cast<float>(height_px) + radius_px);
    if (!outside) raster.Disc(place, radius_px, cloud.rgb[i]);
  }
  return raster;
}

}  // namespace

std::string RenderPng(const ColouredCloud& cloud, const Stand& stand, Angle angle, const RenderOptions& options) {
  const int width_px = 2 * options.width_px, height_px = 2 * options.height_px;
  const Viewpoint view = ViewpointOf(Subject(cloud), stand, angle, width_px, height_px);
  Raster raster = Splatted(cloud, view, width_px, height_px);
  raster.ShadeEdges(0.12F * view.reach_m, 3);
  const Colours colours = ColoursOf(options.background);
  cv::Mat picture = raster.Halved(colours.top, colours.bottom);
  Viewpoint halved = view;
  halved.scale_px /= 2;
  if (!view.perspective) DrawLidar(halved, colours, picture);
  DrawScale(halved, colours, picture);
  std::vector<std::uint8_t> png;
  cv::imencode(".png", picture, png, {cv::IMWRITE_PNG_COMPRESSION, 6});
  return {png.begin(), png.end()};
}

}  // namespace rigcal::cloud
