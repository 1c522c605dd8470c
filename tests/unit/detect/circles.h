// Grids of circles, drawn by a formula of the tests' own.
#pragma once

#include "tests/unit/detect/rendering.h"

namespace rigcal::detect {

// Counts as OpenCV has them: of an asymmetric grid circles of one row, and rows, every other of which is shifted by
// spacing_m; neighbours in a row are 2 spacing_m apart.
struct Circles {
  int cols = 7, rows = 5;
  double spacing_m = 0.03, diameter_m = 0.015;
  bool asymmetric = false, inverted = false;
  [[nodiscard]] Eigen::Vector2d Centre_m(int idx) const;
  [[nodiscard]] Eigen::Vector2d Middle_m() const;
};
// OpenCV's own sheet: 4 x 11.
[[nodiscard]] inline Circles Asymmetric() { return {4, 11, 0.02, 0.014, true, false}; }

[[nodiscard]] Pattern Drawn(const Circles& board);
[[nodiscard]] Target TargetOf(const Circles& board);
[[nodiscard]] std::map<int, Eigen::Vector2d> Truth(const Scene& scene, const Circles& board);
// The same of the board as turned by half, or by a quarter (equal counts).
[[nodiscard]] std::map<int, Eigen::Vector2d> TruthTurned(const Scene& scene, const Circles& board, int quarters);

}  // namespace rigcal::detect
