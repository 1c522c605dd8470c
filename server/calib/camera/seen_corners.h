// The points of a target that one picture shows, which may be a part of them.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "server/model/sensors/features.h"
#include "server/model/sensors/target.h"

namespace rigcal::calib {

// Points of a view that are needed, not on one line: of a single tag all, of other boards more than a tag has, so that
// a wrong one is seen to be wrong.
[[nodiscard]] std::size_t CornersMin(const Target& board);

// `idx` (of TargetPoints) and `uv_px` run side by side, in any order. Empty: the target is not seen.
struct SeenCorners {
  std::vector<int> idx;
  std::vector<Eigen::Vector2d> uv_px;
  // The target is not seen; how many of its points are.
  [[nodiscard]] bool empty() const { return uv_px.empty(); }
  [[nodiscard]] std::size_t size() const { return uv_px.size(); }
};

// Empty: the view can be used. Otherwise why not, in words: not found, indices that are not the target's, a corner that
// is no number, too few points or all of them on one line.
[[nodiscard]] std::string WhyUnusable(const BoardView& view, const Target& board);
// Of a usable view, as if the board were turned by turn * 360 / SymmetryOf(board) degrees.
[[nodiscard]] SeenCorners SeenIn(const BoardView& view, const Target& board, int turn = 0);

}  // namespace rigcal::calib
