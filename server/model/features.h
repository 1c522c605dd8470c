// What detection finds in one picture.
#pragma once

#include <Eigen/Core>
#include <map>
#include <string>
#include <vector>

#include "server/base/ids.h"

namespace rigcal {

// A checkerboard in one picture. Corner i (row-major, column fastest) is at ((i % cols) * square, (i / cols) * square, 0)
// in the board's frame (x along columns, y along rows, z into the board, right-handed, seen from the front).
struct BoardView {
  bool found = false;
  std::string why_not;                      // in words, if not found
  TargetId target;
  int image_width_px = 0, image_height_px = 0;
  std::vector<Eigen::Vector2d> corners_px;  // inner_cols * inner_rows, or empty
};

// The same with the picture of it, encoded, for reports.
struct AnnotatedView {
  BoardView view;
  std::string picture;  // JPEG bytes; empty if the input could not be decoded
};

}  // namespace rigcal
