#include "server/cloud/overlay.h"

#include <algorithm>
#include <cmath>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

namespace rigcal::cloud {
namespace {

constexpr int kWidthMax_px = 1600, kJpegQuality = 90, kColours = 256;
constexpr int kSubPixelBits = 4;

struct Distances {
  double near_m = 1, far_m = 10;

  [[nodiscard]] double Share(double range_m) const {
    return std::clamp(std::log(range_m / near_m) / std::log(far_m / near_m), 0.0, 1.0);
  }
};

Distances DistancesOf(const CameraView& view) {
  std::vector<float> ranges;
  for (const auto& part : view.parts)
    for (const SeenPoint& point : part) ranges.push_back(point.range_m);
  if (ranges.empty()) return {};
  std::sort(ranges.begin(), ranges.end());
  const double near_m = std::max(0.05F, ranges[ranges.size() / 50]), far_m = ranges[(ranges.size() - 1) * 49 / 50];
  return {near_m, std::max(far_m, 1.2 * near_m)};
}

// Near is light yellow, far is violet: light points stand out where it matters, and no colour is used twice.
cv::Mat3b ColourMap() {
  cv::Mat1b steps(1, kColours);
  for (int i = 0; i < kColours; ++i) steps(0, i) = static_cast<std::uint8_t>(255 - i * 185 / (kColours - 1));
  cv::Mat3b map;
  cv::applyColorMap(steps, map, cv::COLORMAP_PLASMA);
  return map;
}

cv::Scalar ColourAt(const cv::Mat3b& map, double share) {
  const cv::Vec3b& bgr = map(0, static_cast<int>(share * (kColours - 1) + 0.5));
  return {static_cast<double>(bgr[0]), static_cast<double>(bgr[1]), static_cast<double>(bgr[2])};
}

cv::Mat Shrunk(const Picture& picture) {
  const cv::Mat rgb(picture.height_px, picture.width_px, CV_8UC3, const_cast<std::uint8_t*>(picture.rgb.data()));
  const double scale = std::min(1.0, static_cast<double>(kWidthMax_px) / picture.width_px);
  cv::Mat small, bgr;
  const cv::Size size(std::max(1, static_cast<int>(std::lround(scale * picture.width_px))),
                      std::max(1, static_cast<int>(std::lround(scale * picture.height_px))));
  cv::resize(rgb, small, size, 0, 0, cv::INTER_AREA);
  cv::cvtColor(small, bgr, cv::COLOR_RGB2BGR);
  return bgr;
}

// So that colours of points are not taken for colours of things.
cv::Mat Dimmed(const cv::Mat& bgr) {
  cv::Mat grey, three, dimmed;
  cv::cvtColor(bgr, grey, cv::COLOR_BGR2GRAY);
  cv::cvtColor(grey, three, cv::COLOR_GRAY2BGR);
  cv::addWeighted(three, 0.5, bgr, 0.15, 0, dimmed);
  return dimmed;
}

std::vector<SeenPoint> FarthestFirst(const CameraView& view) {
  std::vector<SeenPoint> points;
  for (const auto& part : view.parts) points.insert(points.end(), part.begin(), part.end());
  std::stable_sort(points.begin(), points.end(),
                   [](const SeenPoint& x, const SeenPoint& y) { return x.range_m > y.range_m; });
  return points;
}

// Smaller where there are many, so that the picture shows between them.
double RadiusOf(std::size_t points, const cv::Mat& picture) {
  const double spacing_px =
      std::sqrt(static_cast<double>(picture.total()) / std::max<double>(1, static_cast<double>(points)));
  return std::clamp(0.28 * spacing_px, 0.9, 2.6);
}

void DrawPoints(const Picture& picture, const CameraView& view, const Distances& distances, cv::Mat& drawn) {
  const std::vector<SeenPoint> points = FarthestFirst(view);
  const cv::Mat3b map = ColourMap();
  const double one = 1 << kSubPixelBits, scale = static_cast<double>(drawn.cols) / picture.width_px;
  const int radius = static_cast<int>(std::lround(one * RadiusOf(points.size(), drawn)));
  for (const SeenPoint& point : points) {
    const cv::Point at(static_cast<int>(std::lround(one * ((point.u_px + 0.5) * scale - 0.5))),
                       static_cast<int>(std::lround(one * ((point.v_px + 0.5) * scale - 0.5))));
    cv::circle(drawn, at, radius, ColourAt(map, distances.Share(point.range_m)), -1, cv::LINE_AA, kSubPixelBits);
  }
}

std::string Metres(double value_m) {
  char text[32];
  std::snprintf(text, sizeof text, value_m < 9.95 ? "%.1f m" : "%.0f m", value_m);
  return text;
}

void DrawLegend(const Distances& distances, cv::Mat& drawn) {
  const int width = std::min(260, drawn.cols / 3), left = 16, top = drawn.rows - 40, height = 12;
  if (drawn.cols < 240 || drawn.rows < 160) return;
  cv::Mat box = drawn(cv::Rect(left - 8, top - 8, width + 16, 48) & cv::Rect(0, 0, drawn.cols, drawn.rows));
  box.convertTo(box, -1, 0.35);
  const cv::Mat3b map = ColourMap();
  for (int x = 0; x < width; ++x)
    cv::line(drawn, {left + x, top}, {left + x, top + height}, ColourAt(map, static_cast<double>(x) / width), 1);
  const double middle_m = std::sqrt(distances.near_m * distances.far_m);
  for (const auto& [value_m, share] :
       {std::pair(distances.near_m, 0.0), std::pair(middle_m, 0.5), std::pair(distances.far_m, 1.0)}) {
    const std::string text = Metres(value_m);
    const int wide = cv::getTextSize(text, cv::FONT_HERSHEY_SIMPLEX, 0.42, 1, nullptr).width;
    const int x = left + static_cast<int>(share * (width - wide));
    cv::putText(drawn, text, {x, top + height + 16}, cv::FONT_HERSHEY_SIMPLEX, 0.42, {235, 235, 235}, 1, cv::LINE_AA);
  }
}

std::string Jpeg(const cv::Mat& picture) {
  std::vector<std::uint8_t> bytes;
  cv::imencode(".jpg", picture, bytes, {cv::IMWRITE_JPEG_QUALITY, kJpegQuality});
  return {bytes.begin(), bytes.end()};
}

}  // namespace

Overlay OverlayOf(const Picture& picture, const CameraView& view) {
  if (picture.width_px < 1 || picture.height_px < 1) return {};
  const cv::Mat plain = Shrunk(picture);
  cv::Mat drawn = Dimmed(plain);
  const Distances distances = DistancesOf(view);
  DrawPoints(picture, view, distances, drawn);
  DrawLegend(distances, drawn);
  return {Jpeg(drawn), Jpeg(plain)};
}

}  // namespace rigcal::cloud
