// The map between a flat board and its picture, taken locally.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

namespace rigcal::detect {

// A homography from points of the board's plane (any one unit) to pixels. Over a few squares it also holds under lens
// distortion.
class PlaneMap {
 public:
  // Least squares over pairs of points, at least four, no three of four on a line. Nothing if they do not settle it.
  [[nodiscard]] static std::optional<PlaneMap> Fit(const std::vector<Eigen::Vector2d>& board,
                                                   const std::vector<Eigen::Vector2d>& pixels);
  // Nothing for points on the board's horizon or behind it.
  [[nodiscard]] std::optional<Eigen::Vector2d> Pixel(const Eigen::Vector2d& board) const;

 private:
  Eigen::Matrix3d board_part_ = Eigen::Matrix3d::Identity();  // from centred, scaled board points to scaled pixels
  Eigen::Vector2d board_centre_ = Eigen::Vector2d::Zero(), pixel_centre_ = Eigen::Vector2d::Zero();
  double board_scale_ = 1, pixel_scale_ = 1;
};

}  // namespace rigcal::detect
