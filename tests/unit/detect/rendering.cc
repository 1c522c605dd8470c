#include "tests/unit/detect/rendering.h"

#include <cmath>
#include <opencv2/aruco.hpp>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <random>
#include <span>

namespace rigcal::detect {
namespace {

constexpr int kSamples = 12;  // of a pixel, no two in a row or a column, as edges may run along either

Eigen::Vector2d Distorted(const Scene& scene, const Eigen::Vector2d& n) {
  const double r2 = n.squaredNorm(), radial = 1 + scene.k1 * r2 + scene.k2 * r2 * r2, xy = 2 * n.x() * n.y();
  return {n.x() * radial + scene.p1 * xy + scene.p2 * (r2 + 2 * n.x() * n.x()),
          n.y() * radial + scene.p2 * xy + scene.p1 * (r2 + 2 * n.y() * n.y())};
}

Eigen::Vector2d Undistorted(const Scene& scene, const Eigen::Vector2d& wanted) {
  Eigen::Vector2d n = wanted;
  if (scene.k1 == 0 && scene.k2 == 0 && scene.p1 == 0 && scene.p2 == 0) return n;
  for (int step = 0; step < 12; ++step) n += wanted - Distorted(scene, n);
  return n;
}

Eigen::Vector2d Centre(const Scene& scene) { return {0.5 * scene.width_px - 3.3, 0.5 * scene.height_px + 2.7}; }

double GreyAlong(const Scene& scene, const Pattern& pattern, const Eigen::Vector2d& pixel) {
  const Eigen::Vector2d n = Undistorted(scene, (pixel - Centre(scene)) / scene.f_px);
  const Eigen::Vector3d ray = scene.R.transpose() * Eigen::Vector3d(n.x(), n.y(), 1);
  const Eigen::Vector3d eye = -(scene.R.transpose() * scene.t_m);
  const double depth = -eye.z() / ray.z();
  if (!(depth > 0)) return kBackground;
  const double grey = pattern(eye.x() + depth * ray.x(), eye.y() + depth * ray.y());
  return grey < 0 ? kBackground : grey;
}

cv::Mat BitsOf(const std::string& dictionary, int id) {
  static const std::map<std::string, int> kNumbers = {{"DICT_4X4_50", cv::aruco::DICT_4X4_50},
                                                      {"DICT_5X5_100", cv::aruco::DICT_5X5_100},
                                                      {"DICT_6X6_250", cv::aruco::DICT_6X6_250},
                                                      {"DICT_APRILTAG_36h11", cv::aruco::DICT_APRILTAG_36h11}};
  const auto known = cv::aruco::getPredefinedDictionary(kNumbers.at(dictionary));
  return cv::aruco::Dictionary::getBitsFromByteList(known->bytesList.rowRange(id, id + 1), known->markerSize);
}

// u, v in 0 ... 1 of the marker with its border.
bool IsDark(const cv::Mat& bits, int border_bits, double u, double v) {
  const int cells = bits.rows + 2 * border_bits;
  const int col = static_cast<int>(std::floor(u * cells)) - border_bits;
  const int row = static_cast<int>(std::floor(v * cells)) - border_bits;
  return col < 0 || row < 0 || col >= bits.cols || row >= bits.rows || bits.at<std::uint8_t>(row, col) == 0;
}

}  // namespace

Eigen::Vector2d Scene::Pixel(const Eigen::Vector2d& board_m) const {
  const Eigen::Vector3d p = R * Eigen::Vector3d(board_m.x(), board_m.y(), 0) + t_m;
  return Distorted(*this, p.head<2>() / p.z()) * f_px + Centre(*this);
}

bool Scene::InPicture(const Eigen::Vector2d& pixel) const {
  return pixel.x() >= 0 && pixel.y() >= 0 && pixel.x() <= width_px - 1 && pixel.y() <= height_px - 1;
}

Scene Looking(const Eigen::Vector2d& centre_m, double distance_m, double roll_rad, double tilt_x_rad, double tilt_y_rad,
              double right_m, double down_m) {
  Scene scene;
  using Turn = Eigen::AngleAxisd;
  scene.R = (Turn(tilt_x_rad, Eigen::Vector3d::UnitX()) * Turn(tilt_y_rad, Eigen::Vector3d::UnitY()) *
             Turn(roll_rad, Eigen::Vector3d::UnitZ()))
                .toRotationMatrix();
  scene.t_m = Eigen::Vector3d(right_m, down_m, distance_m) - scene.R * Eigen::Vector3d(centre_m.x(), centre_m.y(), 0);
  return scene;
}

cv::Mat Photographed(const Scene& scene, const Pattern& pattern) {
  cv::Mat exact(scene.height_px, scene.width_px, CV_64F);
  for (int y = 0; y < scene.height_px; ++y)
    for (int x = 0; x < scene.width_px; ++x) {
      double sum = 0;
      for (int i = 0; i < kSamples; ++i) {
        const Eigen::Vector2d shift((i + 0.5) / kSamples - 0.5, (i * 5 % kSamples + 0.5) / kSamples - 0.5);
        sum += GreyAlong(scene, pattern, Eigen::Vector2d(x, y) + shift);
      }
      exact.at<double>(y, x) = sum / kSamples;
    }
  if (scene.blur_px > 0) cv::GaussianBlur(exact, exact, {}, scene.blur_px);
  std::mt19937_64 random(scene.seed);
  std::normal_distribution<double> noise(0, scene.noise_grey);
  for (int y = 0; y < scene.height_px && scene.noise_grey > 0; ++y)
    for (int x = 0; x < scene.width_px; ++x) exact.at<double>(y, x) += noise(random);
  cv::Mat grey;
  exact.convertTo(grey, CV_8U);
  return grey;
}

std::string Encoded(const cv::Mat& picture, const std::string& suffix) {
  std::vector<std::uint8_t> bytes;
  cv::imencode(suffix, picture, bytes);
  return {bytes.begin(), bytes.end()};
}

AnnotatedView DetectIn(const cv::Mat& picture, const Target& target) {
  const std::string bytes = Encoded(picture);
  return Detect(std::as_bytes(std::span(bytes)), target);
}

Pattern Checkerboard(int cols, int rows, double square_m, bool first_dark) {
  return [=](double x_m, double y_m) {
    const int col = static_cast<int>(std::floor(x_m / square_m)), row = static_cast<int>(std::floor(y_m / square_m));
    if (col < -2 || row < -2 || col > cols || row > rows) return -1.0;
    if (col < -1 || row < -1 || col >= cols || row >= rows) return kLight;
    return ((col + row) % 2 == 0) == first_dark ? kDark : kLight;
  };
}

Pattern Drawn(const Charuco& board) {
  std::map<std::pair<int, int>, cv::Mat> markers;
  int id = 0;
  for (int row = 0; row < board.squares_y; ++row)
    for (int col = 0; col < board.squares_x; ++col) {
      const int from_dark_corner = board.legacy ? col + board.squares_y - 1 - row : col + row;
      if (from_dark_corner % 2 == 1) markers[{col, row}] = BitsOf(board.dictionary, id++);
    }
  return [board, markers](double x_m, double y_m) {
    const double x = x_m / board.square_m + 1, y = y_m / board.square_m + 1;
    const int col = static_cast<int>(std::floor(x)), row = static_cast<int>(std::floor(y));
    const double light = board.inverted ? kDark : kLight, dark = board.inverted ? kLight : kDark;
    if (x < -0.5 || y < -0.5 || x > board.squares_x + 0.5 || y > board.squares_y + 0.5) return -1.0;
    if (col < 0 || row < 0 || col >= board.squares_x || row >= board.squares_y) return light;
    const auto marker = markers.find({col, row});
    if (marker == markers.end()) return dark;
    const double ratio = board.marker_m / board.square_m;
    const double u = (x - col - 0.5) / ratio + 0.5, v = (y - row - 0.5) / ratio + 0.5;
    if (u < 0 || v < 0 || u >= 1 || v >= 1) return light;
    return IsDark(marker->second, 1, u, v) ? dark : light;
  };
}

Pattern Drawn(const TagGrid& grid) {
  std::vector<cv::Mat> tags;
  for (int i = 0; i < grid.cols * grid.rows; ++i) {
    cv::Mat bits = BitsOf(grid.dictionary, grid.first_id + i).clone();
    for (int turn = 0; turn < grid.code_turns; ++turn) cv::rotate(bits, bits, cv::ROTATE_90_CLOCKWISE);
    tags.push_back(bits);
  }
  return [grid, tags](double x_m, double y_m) {
    const double pitch = 1 + grid.spacing_ratio, x = x_m / grid.tag_m, y = y_m / grid.tag_m;
    const double margin = grid.spacing_ratio + 0.3;
    if (x < -margin || y < -margin || x > grid.cols * pitch - grid.spacing_ratio + margin ||
        y > grid.rows * pitch - grid.spacing_ratio + margin)
      return -1.0;
    const int col = static_cast<int>(std::floor(x / pitch)), row = static_cast<int>(std::floor(y / pitch));
    const double u = x - col * pitch, v = y - row * pitch;
    if (u >= 1 && v >= 1)
      return grid.kalibr && col >= -1 && row >= -1 && col < grid.cols && row < grid.rows ? kDark : kLight;
    if (u >= 1 || v >= 1 || col < 0 || row < 0 || col >= grid.cols || row >= grid.rows) return kLight;
    const int tag = (grid.kalibr ? grid.rows - 1 - row : row) * grid.cols + col;
    return IsDark(tags[static_cast<std::size_t>(tag)], grid.border_bits, u, v) ? kDark : kLight;
  };
}

Pattern Covered(Pattern pattern, const Eigen::Vector2d& centre_m, double radius_m) {
  return [=](double x_m, double y_m) {
    const double distance_m = (Eigen::Vector2d(x_m, y_m) - centre_m).norm();
    return distance_m < radius_m ? 150 + 20 * std::sin(90 * x_m) : pattern(x_m, y_m);
  };
}

Target TargetOf(const Charuco& board) {
  Target target{TargetId("board"), board.squares_x - 1, board.squares_y - 1, board.square_m, 0, ""};
  target.kind = TargetKind::kCharuco;
  target.dictionary = board.dictionary;
  target.marker_m = board.marker_m;
  target.legacy_layout = board.legacy;
  return target;
}

Target TargetOf(const TagGrid& grid) {
  Target target{TargetId("board"), grid.cols, grid.rows, grid.tag_m, 0, ""};
  target.kind = grid.kalibr ? TargetKind::kAprilGrid : TargetKind::kArucoGrid;
  target.dictionary = grid.dictionary;
  target.spacing_ratio = grid.spacing_ratio;
  return target;
}

std::map<int, Eigen::Vector2d> Truth(const Scene& scene, const Charuco& board) {
  std::map<int, Eigen::Vector2d> truth;
  for (int row = 0; row < board.squares_y - 1; ++row)
    for (int col = 0; col < board.squares_x - 1; ++col)
      truth[row * (board.squares_x - 1) + col] = scene.Pixel(Eigen::Vector2d(col, row) * board.square_m);
  return truth;
}

std::map<int, Eigen::Vector2d> Truth(const Scene& scene, const TagGrid& grid) {
  std::map<int, Eigen::Vector2d> truth;
  const double pitch_m = grid.tag_m * (1 + grid.spacing_ratio);
  const Eigen::Vector2d around[4] = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
  for (int row = 0; row < grid.rows; ++row)
    for (int col = 0; col < grid.cols; ++col)
      for (int i = 0; i < 4; ++i) {
        const int tag = (grid.kalibr ? grid.rows - 1 - row : row) * grid.cols + col;
        truth[4 * tag + i] = scene.Pixel(Eigen::Vector2d(col, row) * pitch_m + around[i] * grid.tag_m);
      }
  return truth;
}

Errors ErrorsOf(const BoardView& view, const std::map<int, Eigen::Vector2d>& truth) {
  Errors errors;
  double sum = 0;
  for (std::size_t i = 0; i < view.corners_px.size(); ++i) {
    const auto expected = truth.find(view.corner_idx[i]);
    const double error_px = expected == truth.end() ? HUGE_VAL : (view.corners_px[i] - expected->second).norm();
    errors.largest_px = std::max(errors.largest_px, error_px);
    sum += error_px * error_px;
  }
  if (!view.corners_px.empty()) errors.rms_px = std::sqrt(sum / static_cast<double>(view.corners_px.size()));
  return errors;
}

}  // namespace rigcal::detect
