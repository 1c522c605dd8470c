// Pictures for measuring the search of checkerboards: boards drawn by formulas, among clutter that looks like boards.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <opencv2/core.hpp>
#include <random>
#include <vector>

#include "server/detect/pictures/grey_image.h"

namespace rigcal::detect {

using Random = std::mt19937_64;
// The same on every machine, unlike std::uniform_real_distribution.
[[nodiscard]] double Uniform(Random& random, double min, double max);
[[nodiscard]] int Whole(Random& random, int min, int max);  // both included

struct PictureWish {
  int cols = 9, rows = 6;  // inner corners
  double square_px = 40;   // side of a square at the board's middle, were it not tilted
  double tilt_rad = 0;     // about an axis in the board
  double tilt_axis_rad = 0, roll_rad = 0;
  Eigen::Vector2d middle_px = Eigen::Vector2d::Zero();
  double dark = 35, light = 215;
  double margin_squares = 1;  // light rim around the outer squares
  double shade = 0;           // part of the light that is lost from one side of the picture to the other
};

// Draws the board and gives the pixels of its inner corners, row-major, the square between the first ones dark.
std::vector<Eigen::Vector2d> DrawBoard(const PictureWish& wish, cv::Mat& picture);
// Floor tiles, windows, keyboards, bricks, stripes and boxes, each over a part of the picture.
void DrawClutter(Random& random, cv::Mat& picture);
void Expose(Random& random, double blur_px, double noise_grey, cv::Mat& picture);

[[nodiscard]] GreyImage AsImage(const cv::Mat& picture);
// The picture repeated over a larger canvas, every second copy mirrored.
[[nodiscard]] cv::Mat Tiled(const cv::Mat& picture, int width_px, int height_px);

// A board anywhere in the picture, wholly inside it, tilted up to `tilt_max_rad`; square_px is kept.
[[nodiscard]] PictureWish Placed(Random& random, PictureWish wish, double tilt_max_rad, int width_px, int height_px);

}  // namespace rigcal::detect
