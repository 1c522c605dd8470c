#include "tests/bench/sensors/board_pictures.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

namespace rigcal::detect {
namespace {

constexpr int kSamples = 32;  // of a pixel

// From squares, with the first inner corner at 0, 0, to pixels.
Eigen::Matrix3d MapOf(const PictureWish& wish) {
  constexpr double kDistance_px = 3000;  // of the pinhole camera, and its focal length
  const Eigen::Vector3d axis(std::cos(wish.tilt_axis_rad), std::sin(wish.tilt_axis_rad), 0);
  const Eigen::Matrix3d R =
      (Eigen::AngleAxisd(wish.tilt_rad, axis) * Eigen::AngleAxisd(wish.roll_rad, Eigen::Vector3d::UnitZ()))
          .toRotationMatrix();
  const Eigen::Vector2d middle((wish.cols - 1) / 2.0, (wish.rows - 1) / 2.0);
  Eigen::Matrix3d map;
  map.col(0) = R.col(0) * wish.square_px;
  map.col(1) = R.col(1) * wish.square_px;
  map.col(2) = Eigen::Vector3d(0, 0, kDistance_px) - map.col(0) * middle.x() - map.col(1) * middle.y();
  Eigen::Matrix3d camera = Eigen::Matrix3d::Identity();
  camera(0, 0) = camera(1, 1) = kDistance_px;
  camera(0, 2) = wish.middle_px.x(), camera(1, 2) = wish.middle_px.y();
  return camera * map;
}

// Part of a pixel from its centre, -1/2 to 1/2, of sample i: no two share a column or a row (Hammersley), so that edges
// along the pixels are as exact as slanted ones.
Eigen::Vector2d SampleAt(int i) {
  int reversed = 0;
  for (int bit = 1; bit < kSamples; bit *= 2) reversed = 2 * reversed + ((i & bit) != 0 ? 1 : 0);
  return Eigen::Vector2d(i + 0.5, reversed + 0.5) / kSamples - Eigen::Vector2d(0.5, 0.5);
}

// Negative: beside the board.
double GreyAt(const PictureWish& wish, double x, double y) {
  const double rim = 1 + wish.margin_squares;
  if (x < -rim || y < -rim || x >= wish.cols - 1 + rim || y >= wish.rows - 1 + rim) return -1;
  const int col = static_cast<int>(std::floor(x)), row = static_cast<int>(std::floor(y));
  if (x < -1 || y < -1 || x >= wish.cols || y >= wish.rows) return wish.light;
  return (col + row) % 2 == 0 ? wish.dark : wish.light;
}

void DrawPixel(const PictureWish& wish, const Eigen::Matrix3d& back, int x, int y, cv::Mat& picture) {
  double sum = 0;
  const double before = picture.at<std::uint8_t>(y, x);
  for (int i = 0; i < kSamples; ++i) {
    const Eigen::Vector2d off_px = SampleAt(i);
    const Eigen::Vector3d at = back * Eigen::Vector3d(x + off_px.x(), y + off_px.y(), 1);
    const double grey = GreyAt(wish, at.x() / at.z(), at.y() / at.z());
    sum += grey < 0 ? before : grey * (1 - wish.shade * x / picture.cols);
  }
  picture.at<std::uint8_t>(y, x) = cv::saturate_cast<std::uint8_t>(sum / kSamples);
}

cv::Rect Somewhere(Random& random, const cv::Mat& picture) {
  const int width = Whole(random, picture.cols / 6, picture.cols / 2);
  const int height = Whole(random, picture.rows / 6, picture.rows / 2);
  return {Whole(random, 0, picture.cols - width), Whole(random, 0, picture.rows - height), width, height};
}

// Cells of one grey, with lines of another between them: tiles, windows, bricks, keys.
void DrawCells(Random& random, cv::Mat& part) {
  const int width = Whole(random, 12, 160), height = Whole(random, 0, 1) == 0 ? width : Whole(random, 12, 160);
  const int line = Whole(random, 1, std::max(2, width / 5)), shift = Whole(random, 0, 2) * width / 4;
  const int cell = Whole(random, 10, 245), gap = Whole(random, 10, 245), vary = Whole(random, 0, 60);
  const bool labels = Whole(random, 0, 2) == 0;
  part.setTo(gap);
  for (int y = 0, row = 0; y < part.rows; y += height, ++row)
    for (int x = -(row * shift) % width; x < part.cols; x += width) {
      const int grey = cell + Whole(random, -vary, vary);
      cv::rectangle(part, cv::Rect(x, y, width - line, height - line), cv::Scalar(std::clamp(grey, 0, 255)), -1);
      if (labels)
        cv::putText(part, std::string(1, static_cast<char>('A' + Whole(random, 0, 25))),
                    {x + width / 4, y + 3 * height / 4}, cv::FONT_HERSHEY_SIMPLEX, height / 45.0,
                    cv::Scalar(255 - cell), std::max(1, height / 20));
    }
}

void DrawBoxes(Random& random, cv::Mat& part) {
  for (int i = 0; i < 60; ++i) {
    const cv::RotatedRect box(
        {static_cast<float>(Whole(random, 0, part.cols)), static_cast<float>(Whole(random, 0, part.rows))},
        {static_cast<float>(Whole(random, 5, 120)), static_cast<float>(Whole(random, 5, 120))},
        static_cast<float>(Whole(random, 0, 90)));
    cv::Point2f corners[4];
    box.points(corners);
    const std::vector<cv::Point> filled(corners, corners + 4);
    cv::fillConvexPoly(part, filled, cv::Scalar(Whole(random, 0, 255)));
  }
}

// Squares of random grey: much like a board in places.
void DrawMosaic(Random& random, cv::Mat& part) {
  const int side = Whole(random, 8, 60);
  for (int y = 0; y < part.rows; y += side)
    for (int x = 0; x < part.cols; x += side)
      cv::rectangle(part, cv::Rect(x, y, side, side), cv::Scalar(Whole(random, 0, 1) == 0 ? 40 : 200), -1);
}

}  // namespace

double Uniform(Random& random, double min, double max) {
  return min + (max - min) * (static_cast<double>(random() >> 11) * 0x1.0p-53);
}

int Whole(Random& random, int min, int max) {
  return min + static_cast<int>(random() % static_cast<std::uint64_t>(max - min + 1));
}

std::vector<Eigen::Vector2d> DrawBoard(const PictureWish& wish, cv::Mat& picture) {
  const Eigen::Matrix3d map = MapOf(wish), back = map.inverse();
  const double rim = 1 + wish.margin_squares;
  Eigen::Array2d min(HUGE_VAL, HUGE_VAL), max = -min;
  for (const double x : {-rim, wish.cols - 1 + rim})
    for (const double y : {-rim, wish.rows - 1 + rim}) {
      const Eigen::Array2d at = (map * Eigen::Vector3d(x, y, 1)).hnormalized();
      min = min.min(at), max = max.max(at);
    }
  for (int y = std::max(0, static_cast<int>(min.y()) - 1); y < std::min<double>(picture.rows, max.y() + 2); ++y)
    for (int x = std::max(0, static_cast<int>(min.x()) - 1); x < std::min<double>(picture.cols, max.x() + 2); ++x)
      DrawPixel(wish, back, x, y, picture);
  std::vector<Eigen::Vector2d> corners_px;
  for (int row = 0; row < wish.rows; ++row)
    for (int col = 0; col < wish.cols; ++col)
      corners_px.emplace_back((map * Eigen::Vector3d(col, row, 1)).hnormalized());
  return corners_px;
}

void DrawClutter(Random& random, cv::Mat& picture) {
  for (int i = 0; i < 8; ++i) {
    cv::Mat part = picture(Somewhere(random, picture));
    const int kind = Whole(random, 0, 5);
    if (kind <= 3)
      DrawCells(random, part);
    else if (kind == 4)
      DrawBoxes(random, part);
    else
      DrawMosaic(random, part);
  }
}

void Expose(Random& random, double blur_px, double noise_grey, cv::Mat& picture) {
  if (blur_px > 0) cv::GaussianBlur(picture, picture, {}, blur_px);
  if (noise_grey <= 0) return;
  for (int y = 0; y < picture.rows; ++y)
    for (int x = 0; x < picture.cols; ++x) {
      // Four of 16 bits: close to normal.
      const std::uint64_t bits = random();
      double sum = -2 * 65535.0;
      for (int i = 0; i < 4; ++i) sum += static_cast<double>((bits >> (16 * i)) & 0xffff);
      std::uint8_t& grey = picture.at<std::uint8_t>(y, x);
      grey = cv::saturate_cast<std::uint8_t>(grey + noise_grey * sum / (65536 * std::sqrt(4 / 12.0)));
    }
}

GreyImage AsImage(const cv::Mat& picture) {
  GreyImage image{picture.cols, picture.rows, {}};
  for (int y = 0; y < picture.rows; ++y)
    image.pixels.insert(image.pixels.end(), picture.ptr(y), picture.ptr(y) + picture.cols);
  return image;
}

cv::Mat Tiled(const cv::Mat& picture, int width_px, int height_px) {
  cv::Mat tiled(height_px, width_px, CV_8U);
  for (int y = 0; y < height_px; ++y)
    for (int x = 0; x < width_px; ++x) {
      const int col = x % picture.cols, row = y % picture.rows;
      tiled.at<std::uint8_t>(y, x) = picture.at<std::uint8_t>(y / picture.rows % 2 == 0 ? row : picture.rows - 1 - row,
                                                              x / picture.cols % 2 == 0 ? col : picture.cols - 1 - col);
    }
  return tiled;
}

PictureWish Placed(Random& random, PictureWish wish, double tilt_max_rad, int width_px, int height_px) {
  wish.roll_rad = Uniform(random, 0, 2 * M_PI);
  wish.tilt_axis_rad = Uniform(random, 0, 2 * M_PI);
  wish.tilt_rad = Uniform(random, 0, tilt_max_rad);
  // A third more than the half diagonal, as the near side of a tilted board looks larger.
  const double reach_px = 0.5 * std::hypot(wish.cols + 1, wish.rows + 1) * wish.square_px * 1.15 + 8;
  const double free_x = std::max(0.0, width_px / 2.0 - reach_px), free_y = std::max(0.0, height_px / 2.0 - reach_px);
  wish.middle_px = {width_px / 2.0 + Uniform(random, -free_x, free_x),
                    height_px / 2.0 + Uniform(random, -free_y, free_y)};
  return wish;
}

}  // namespace rigcal::detect
