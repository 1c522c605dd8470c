// Boards drawn and photographed by formulas of the tests' own: the oracle of detection.
#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <functional>
#include <map>
#include <opencv2/core.hpp>
#include <string>
#include <vector>

#include "server/detect/board.h"

namespace rigcal::detect {

// Grey of the board's plane at x, y in metres (frame of Target); negative: nothing there.
using Pattern = std::function<double(double x_m, double y_m)>;

inline constexpr double kDark = 35, kLight = 215, kBackground = 120;

// A camera and where the board is in it: p_cam = R p_board + t_m.
struct Scene {
  Eigen::Matrix3d R = Eigen::Matrix3d::Identity();
  Eigen::Vector3d t_m = Eigen::Vector3d::UnitZ();
  int width_px = 640, height_px = 480;
  double f_px = 600;
  double k1 = 0, k2 = 0, p1 = 0, p2 = 0;
  double blur_px = 0.7, noise_grey = 2.0;
  std::uint64_t seed = 1;

  [[nodiscard]] Eigen::Vector2d Pixel(const Eigen::Vector2d& board_m) const;
  [[nodiscard]] bool InPicture(const Eigen::Vector2d& pixel) const;
};

// The point `centre_m` of the board `distance_m` in front of the camera, `right_m` and `down_m` of its axis; the board
// is rolled about the axis, then tilted.
[[nodiscard]] Scene Looking(const Eigen::Vector2d& centre_m, double distance_m, double roll_rad, double tilt_x_rad = 0,
                            double tilt_y_rad = 0, double right_m = 0, double down_m = 0);
[[nodiscard]] cv::Mat Photographed(const Scene& scene, const Pattern& pattern);
[[nodiscard]] std::string Encoded(const cv::Mat& picture, const std::string& suffix = ".png");
[[nodiscard]] AnnotatedView DetectIn(const cv::Mat& picture, const Target& target);

// The first inner square (between the first two corners of the first two rows) dark or light; a light margin of one
// square around the outer squares.
[[nodiscard]] Pattern Checkerboard(int cols, int rows, double square_m, bool first_dark = true);
// From squares, as people count them. `legacy`: numbered from a dark square at the bottom left.
struct Charuco {
  int squares_x = 5, squares_y = 7;
  double square_m = 0.04, marker_m = 0.03;
  std::string dictionary = "DICT_4X4_50";
  bool legacy = false, inverted = false;
};
[[nodiscard]] Pattern Drawn(const Charuco& board);
// Tags numbered from the bottom left if `kalibr`, with a dark square where four gaps meet (and at the outer corners).
struct TagGrid {
  int cols = 6, rows = 6;
  double tag_m = 0.03, spacing_ratio = 0.3;
  std::string dictionary = "DICT_APRILTAG_36h11";
  int border_bits = 2, code_turns = 0, first_id = 0;
  bool kalibr = true;
};
[[nodiscard]] Pattern Drawn(const TagGrid& grid);
// `pattern` with a light-brown hand over the disc about centre_m.
[[nodiscard]] Pattern Covered(Pattern pattern, const Eigen::Vector2d& centre_m, double radius_m);

// The board as the product's value.
[[nodiscard]] Target TargetOf(const Charuco& board);
[[nodiscard]] Target TargetOf(const TagGrid& grid);
// Every point's true pixel by index.
[[nodiscard]] std::map<int, Eigen::Vector2d> Truth(const Scene& scene, const Charuco& board);
[[nodiscard]] std::map<int, Eigen::Vector2d> Truth(const Scene& scene, const TagGrid& grid);

// Of found corners against the truth; infinite where an index is unknown.
struct Errors {
  double rms_px = 0, largest_px = 0;
};
[[nodiscard]] Errors ErrorsOf(const BoardView& view, const std::map<int, Eigen::Vector2d>& truth);

}  // namespace rigcal::detect
