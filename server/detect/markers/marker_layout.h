// Where the markers of a board are printed, and which of those seen in a picture agree with it.
#pragma once

#include <Eigen/Core>
#include <array>
#include <vector>

#include "server/detect/markers/markers.h"
#include "server/model/sensors/target.h"

namespace rigcal::detect {

// Corners in the board's plane: top left, top right, bottom right, bottom left as printed.
using BoardQuad = std::array<Eigen::Vector2d, 4>;

struct MarkerLayout {
  double pitch_m = 0;            // from marker to marker: a square, or a tag and a gap
  std::vector<BoardQuad> quads;  // metres, in the order in which they are numbered
};

// Markers in the white squares, numbered row by row. The first square is dark, unless `legacy` (OpenCV before 4.6) and
// the rows of squares are even: then it is white and has marker 0.
[[nodiscard]] MarkerLayout CharucoLayout(const Target& target, bool legacy);
// Is there a marker in the square whose bottom right corner is inner corner (col, row)?
[[nodiscard]] bool HasMarker(const Target& target, bool legacy, int col, int row);
// The points of TargetPoints(), four a tag.
[[nodiscard]] MarkerLayout GridLayout(const Target& target);

// A marker that is where its neighbours say.
struct PlacedMarker {
  int place = 0;  // which of the layout's
  BoardQuad board_m;
  std::array<Eigen::Vector2d, 4> corners_px;  // of the same corners
};

// The largest set of markers that form one board, each in agreement with a marker at most three pitches away, in the
// layout's order; of a layout of one marker that one, where it is seen once.
// `turn`: quarter turns (0 to 3) by which the printed codes are turned against OpenCV's. Empty if no two agree.
[[nodiscard]] std::vector<PlacedMarker> Placed(const MarkerLayout& layout, const std::vector<SeenMarker>& seen,
                                               int turn);
// Are the markers in agreement enough of those seen? Where most are elsewhere, the board has other counts than the
// layout.
// `needed`: so many have to be, all of a board of fewer.
[[nodiscard]] bool Credible(std::size_t placed, std::size_t seen, std::size_t needed = 2);

}  // namespace rigcal::detect
