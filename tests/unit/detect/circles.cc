#include "tests/unit/detect/circles.h"

#include <cmath>

namespace rigcal::detect {

Eigen::Vector2d Circles::Centre_m(int idx) const {
  const int col = idx % cols, row = idx / cols;
  return Eigen::Vector2d(asymmetric ? 2 * col + row % 2 : col, row) * spacing_m;
}

Eigen::Vector2d Circles::Middle_m() const {
  return Eigen::Vector2d(asymmetric ? 2 * cols - 1 : cols - 1, rows - 1) * spacing_m / 2;
}

Pattern Drawn(const Circles& board) {
  return [board](double x_m, double y_m) {
    const Eigen::Vector2d at_m(x_m, y_m),
        margin_m = Eigen::Vector2d::Constant(board.diameter_m / 2 + 0.6 * board.spacing_m);
    const Eigen::Vector2d size_m = 2 * board.Middle_m();
    if (((at_m + margin_m).array() < 0).any() || ((at_m - size_m - margin_m).array() > 0).any()) return -1.0;
    const int near_row = static_cast<int>(std::lround(y_m / board.spacing_m));
    for (int row = near_row - 1; row <= near_row + 1; ++row) {
      const double pitch_m = board.asymmetric ? 2 * board.spacing_m : board.spacing_m;
      const double shift_m = board.asymmetric && row % 2 != 0 ? board.spacing_m : 0;
      const int col = static_cast<int>(std::lround((x_m - shift_m) / pitch_m));
      if (row < 0 || row >= board.rows || col < 0 || col >= board.cols) continue;
      if ((at_m - board.Centre_m(row * board.cols + col)).norm() < board.diameter_m / 2)
        return board.inverted ? kLight : kDark;
    }
    return board.inverted ? kDark : kLight;
  };
}

Target TargetOf(const Circles& board) {
  Target target{TargetId("board"), board.cols, board.rows, board.spacing_m, 0, ""};
  target.kind = board.asymmetric ? TargetKind::kAsymmetricCircleGrid : TargetKind::kCircleGrid;
  target.diameter_m = board.diameter_m;
  return target;
}

std::map<int, Eigen::Vector2d> Truth(const Scene& scene, const Circles& board) { return TruthTurned(scene, board, 0); }

std::map<int, Eigen::Vector2d> TruthTurned(const Scene& scene, const Circles& board, int quarters) {
  std::map<int, Eigen::Vector2d> truth;
  for (int idx = 0; idx < board.cols * board.rows; ++idx) {
    Eigen::Vector2d away_m = board.Centre_m(idx) - board.Middle_m();
    for (int turn = 0; turn < quarters; ++turn) away_m = Eigen::Vector2d(-away_m.y(), away_m.x());
    truth[idx] = scene.Pixel(board.Middle_m() + away_m);
  }
  return truth;
}

}  // namespace rigcal::detect
