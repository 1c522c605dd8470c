// A smooth field of shifts over a camera's picture, in px for u and for v: tensor products of uniform quadratic
// B-splines (de Boor 2001, ch. IX), one coefficient each per control point of a square grid.
#pragma once

#include <Eigen/Core>
#include <array>

namespace rigcal::calib::joint {

// Of the longer side of a picture: what bends within less than two cells is left to the noise. Of coarser grids the
// cost was honesty: what they cannot follow is no noise, as neighbouring corners share it.
constexpr int kFieldCells = 10;

struct PictureSize {
  int width_px = 0, height_px = 0;
  [[nodiscard]] bool empty() const { return width_px <= 0 || height_px <= 0; }  // the size is not known
};

// Control points of the grid, whose cells are squares of the longer side / kFieldCells.
struct FieldGrid {
  int columns = 0, rows = 0;
  double cell_px = 1.0;
  PictureSize picture = {};
  [[nodiscard]] int points() const { return columns * rows; }  // how many there are
};
[[nodiscard]] FieldGrid FieldGridOf(const PictureSize& picture);  // of an empty picture: no points

// The nine control points that reach a pixel, and by how much; the sum is 1. Pixels beside the picture are moved to its
// edge.
struct FieldWeights {
  std::array<int, 9> point = {};
  std::array<double, 9> weight = {};
};
// Quadratic B-splines; the grid has points, `uv_px` is finite.
[[nodiscard]] FieldWeights FieldWeightsAt(const FieldGrid& grid, const Eigen::Vector2d& uv_px);

// `coefficients_px`: of u at all control points, then of v.
[[nodiscard]] Eigen::Vector2d FieldAt(const FieldGrid& grid, const Eigen::VectorXd& coefficients_px,
                                      const Eigen::Vector2d& uv_px);

}  // namespace rigcal::calib::joint
