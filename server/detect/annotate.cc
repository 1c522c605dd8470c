#include "server/detect/annotate.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <vector>

namespace rigcal::detect {
namespace {

constexpr int kWidthMaxPx = 1280;
constexpr int kJpegQuality = 85;
constexpr int kSubPixelBits = 4;  // drawing coordinates are fixed point
const cv::Scalar kRowColour(80, 200, 60), kCornerColour(40, 90, 255), kXColour(60, 60, 235), kYColour(235, 140, 40);

struct Canvas {
  cv::Mat picture;
  double scale = 1;

  [[nodiscard]] cv::Point Fixed(const Eigen::Vector2d& uv_px) const {
    const Eigen::Vector2d scaled = ((uv_px.array() + 0.5) * scale - 0.5) * (1 << kSubPixelBits);
    return {static_cast<int>(std::lround(scaled.x())), static_cast<int>(std::lround(scaled.y()))};
  }
  void Line(const Eigen::Vector2d& from, const Eigen::Vector2d& to, const cv::Scalar& colour, int thickness) {
    cv::line(picture, Fixed(from), Fixed(to), colour, thickness, cv::LINE_AA, kSubPixelBits);
  }
  void Circle(const Eigen::Vector2d& centre, int radius_px, const cv::Scalar& colour, int thickness) {
    cv::circle(picture, Fixed(centre), radius_px << kSubPixelBits, colour, thickness, cv::LINE_AA, kSubPixelBits);
  }
  void Text(const std::string& text, const Eigen::Vector2d& at, const cv::Scalar& colour) {
    const Eigen::Vector2d scaled = at * scale;
    const cv::Point place(static_cast<int>(std::lround(scaled.x())) + 4, static_cast<int>(std::lround(scaled.y())) - 4);
    cv::putText(picture, text, place, cv::FONT_HERSHEY_SIMPLEX, 0.6, cv::Scalar::all(255), 4, cv::LINE_AA);
    cv::putText(picture, text, place, cv::FONT_HERSHEY_SIMPLEX, 0.6, colour, 2, cv::LINE_AA);
  }
};

Canvas MakeCanvas(const GreyImage& image) {
  const cv::Mat grey(image.height_px, image.width_px, CV_8U, const_cast<std::uint8_t*>(image.pixels.data()));
  Canvas canvas;
  cv::Mat small = grey;
  if (image.width_px > kWidthMaxPx) {
    canvas.scale = static_cast<double>(kWidthMaxPx) / image.width_px;
    const int height_px = std::max(1, static_cast<int>(std::lround(image.height_px * canvas.scale)));
    cv::resize(grey, small, {kWidthMaxPx, height_px}, 0, 0, cv::INTER_AREA);
  }
  cv::cvtColor(small, canvas.picture, cv::COLOR_GRAY2BGR);
  return canvas;
}

void DrawBoard(Canvas& canvas, const std::vector<Eigen::Vector2d>& corners, std::size_t inner_cols) {
  for (std::size_t i = 1; i < corners.size(); ++i) canvas.Line(corners[i - 1], corners[i], kRowColour, 1);
  for (const Eigen::Vector2d& corner : corners) canvas.Circle(corner, 3, kCornerColour, 1);
  const Eigen::Vector2d& origin = corners.front();
  canvas.Line(origin, corners[1], kXColour, 2);
  canvas.Line(origin, corners[inner_cols], kYColour, 2);
  canvas.Circle(origin, 8, kXColour, 2);
  canvas.Text("x", corners[1], kXColour);
  canvas.Text("y", corners[inner_cols], kYColour);
}

}  // namespace

std::string Annotated(const GreyImage& image, const BoardView& view, int inner_cols) {
  Canvas canvas = MakeCanvas(image);
  if (view.found) DrawBoard(canvas, view.corners_px, static_cast<std::size_t>(inner_cols));
  std::vector<std::uint8_t> jpeg;
  cv::imencode(".jpg", canvas.picture, jpeg, {cv::IMWRITE_JPEG_QUALITY, kJpegQuality});
  return std::string(jpeg.begin(), jpeg.end());
}

}  // namespace rigcal::detect
