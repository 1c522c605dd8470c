#include "server/detect/pictures/annotate.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <map>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <optional>
#include <utility>
#include <vector>

namespace rigcal::detect {
namespace {

constexpr int kWidthMaxPx = 1280;
constexpr int kJpegQuality = 85;
constexpr int kSubPixelBits = 4;  // drawing coordinates are fixed point
constexpr std::size_t kLabels = 6;
constexpr double kLabelSize = 0.45;
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
  void Text(const std::string& text, const Eigen::Vector2d& at, const cv::Scalar& colour, double size = 0.6) {
    const Eigen::Vector2d scaled = at * scale;
    const cv::Point place(static_cast<int>(std::lround(scaled.x())) + 4, static_cast<int>(std::lround(scaled.y())) - 4);
    cv::putText(picture, text, place, cv::FONT_HERSHEY_SIMPLEX, size, cv::Scalar::all(255), 4, cv::LINE_AA);
    cv::putText(picture, text, place, cv::FONT_HERSHEY_SIMPLEX, size, colour, size < 0.5 ? 1 : 2, cv::LINE_AA);
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

void DrawBoard(Canvas& canvas, const std::vector<Eigen::Vector2d>& corners, std::size_t cols) {
  for (std::size_t i = 1; i < corners.size(); ++i) canvas.Line(corners[i - 1], corners[i], kRowColour, 1);
  for (const Eigen::Vector2d& corner : corners) canvas.Circle(corner, 3, kCornerColour, 1);
  const Eigen::Vector2d& origin = corners.front();
  canvas.Line(origin, corners[1], kXColour, 2);
  canvas.Line(origin, corners[cols], kYColour, 2);
  canvas.Circle(origin, 8, kXColour, 2);
  canvas.Text("x", corners[1], kXColour);
  canvas.Text("y", corners[cols], kYColour);
}

// Found corners by their place on the board, in units that are whole for equal places.
class Places {
 public:
  Places(const BoardView& view, const Target& target) : unit_m_(target.square_m / 1000) {
    const std::vector<Eigen::Vector3d> points = TargetPoints(target);
    for (std::size_t i = 0; i < view.corner_idx.size(); ++i) {
      board_m_.push_back(points[static_cast<std::size_t>(view.corner_idx[i])].head<2>());
      index_.emplace(Key(board_m_.back()), i);
    }
  }
  [[nodiscard]] const Eigen::Vector2d& Board_m(std::size_t i) const { return board_m_[i]; }
  [[nodiscard]] std::optional<std::size_t> At(const Eigen::Vector2d& board_m) const {
    const auto found = index_.find(Key(board_m));
    return found == index_.end() ? std::nullopt : std::optional(found->second);
  }

 private:
  [[nodiscard]] std::pair<long, long> Key(const Eigen::Vector2d& board_m) const {
    return {std::lround(board_m.x() / unit_m_), std::lround(board_m.y() / unit_m_)};
  }
  double unit_m_;
  std::vector<Eigen::Vector2d> board_m_;
  std::map<std::pair<long, long>, std::size_t> index_;
};

void DrawAxes(Canvas& canvas, const BoardView& view, const Target& target, const Places& places) {
  const std::size_t origin = places.At(Eigen::Vector2d::Zero()).value_or(0);
  canvas.Circle(view.corners_px[origin], 8, kXColour, 2);
  const auto draw = [&](const Eigen::Vector2d& step_m, const char* name, const cv::Scalar& colour) {
    const auto next = places.At(places.Board_m(origin) + step_m);
    if (!next) return;
    canvas.Line(view.corners_px[origin], view.corners_px[*next], colour, 2);
    canvas.Text(name, view.corners_px[*next], colour);
  };
  draw({target.square_m, 0}, "x", kXColour);
  draw({0, target.square_m}, "y", kYColour);
}

void DrawPart(Canvas& canvas, const BoardView& view, const Target& target) {
  const Places places(view, target);
  const std::size_t count = view.corners_px.size(), labels_every = std::max<std::size_t>(1, count / kLabels);
  for (std::size_t i = 0; i < count; ++i) {
    const auto right = places.At(places.Board_m(i) + Eigen::Vector2d(target.square_m, 0));
    const auto below = places.At(places.Board_m(i) + Eigen::Vector2d(0, target.square_m));
    if (right) canvas.Line(view.corners_px[i], view.corners_px[*right], kRowColour, 1);
    if (below && IsTagGrid(target.kind)) canvas.Line(view.corners_px[i], view.corners_px[*below], kRowColour, 1);
  }
  for (std::size_t i = 0; i < count; ++i) canvas.Circle(view.corners_px[i], 3, kCornerColour, 1);
  DrawAxes(canvas, view, target, places);
  for (std::size_t i = 0; i < count; i += labels_every)
    canvas.Text(std::to_string(view.corner_idx[i]), view.corners_px[i], kCornerColour, kLabelSize);
}

}  // namespace

std::string Annotated(const GreyImage& image, const BoardView& view, const Target& target) {
  Canvas canvas = MakeCanvas(image);
  if (view.found && (target.kind == TargetKind::kCheckerboard || IsCircleGrid(target.kind)))
    DrawBoard(canvas, view.corners_px, static_cast<std::size_t>(target.cols));
  else if (view.found)
    DrawPart(canvas, view, target);
  std::vector<std::uint8_t> jpeg;
  cv::imencode(".jpg", canvas.picture, jpeg, {cv::IMWRITE_JPEG_QUALITY, kJpegQuality});
  return std::string(jpeg.begin(), jpeg.end());
}

}  // namespace rigcal::detect
