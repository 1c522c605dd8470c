#include "server/calib/board_points.h"

namespace rigcal::calib {

std::vector<Eigen::Vector3d> BoardPoints(const Checkerboard& board) {
  std::vector<Eigen::Vector3d> points;
  for (int row = 0; row < board.inner_rows; ++row)
    for (int col = 0; col < board.inner_cols; ++col)
      points.emplace_back(col * board.square_m, row * board.square_m, 0.0);
  return points;
}

}  // namespace rigcal::calib
