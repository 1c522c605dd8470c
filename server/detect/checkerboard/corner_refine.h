// One corner made exact to a part of a pixel, and corners checked against their neighbours.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "server/detect/pictures/grey_image.h"
#include "server/model/sensors/features.h"

namespace rigcal::detect {

// A corner of the board: its index, its place on the board (metres) and in the picture.
struct BoardCorner {
  int idx = 0;
  Eigen::Vector2d board_m, corner_px;
};

// Where the edges meet around `start_px`, within `window_px` (half a side), on the picture smoothed by 1 px (less
// in small windows): the refinement takes every pixel's gradient for an edge's, and noise has gradients too. The start
// itself where there is no such place, or where the picture ends before the window.
[[nodiscard]] Eigen::Vector2d EdgesMeet(const GreyImage& image, const Eigen::Vector2d& start_px, int window_px);

// Where the edges meet within `window_px` (half a side) of `start_px`. Nothing if that is further away than
// `move_max_px`, or too close to the picture's border to tell. Throws what OpenCV throws.
[[nodiscard]] std::optional<Eigen::Vector2d> Refined(const GreyImage& image, const Eigen::Vector2d& start_px,
                                                     int window_px, double move_max_px);

// Leaves out corners that are not where the corners around them (within 2.5 `pitch_m`) say, by a twelfth of the pitch
// and at least a pixel; the worst first. Only neighbours are asked, so that lens distortion does no harm. Keeps the
// order.
[[nodiscard]] std::vector<BoardCorner> Consistent(std::vector<BoardCorner> corners, double pitch_m);

// Can a pose be told from them: at least `count_min`, and no line on the board with all of them, or all but one?
[[nodiscard]] bool SpreadEnough(const std::vector<BoardCorner>& corners, std::size_t count_min);

// As those of a board that was found.
void Show(const std::vector<BoardCorner>& corners, BoardView& view);

}  // namespace rigcal::detect
