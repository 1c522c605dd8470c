#include "server/calib/camera/seen_corners.h"

#include <Eigen/Eigenvalues>
#include <algorithm>

namespace rigcal::calib {
namespace {

// Smaller over larger spread of the points: a single row of corners has 0.
constexpr double kLineRatio = 0.05;

bool OnOneLine(const std::vector<int>& idx, const std::vector<Eigen::Vector3d>& corners_board) {
  Eigen::Vector2d mean = Eigen::Vector2d::Zero();
  for (const int i : idx)
    mean += corners_board[static_cast<std::size_t>(i)].head<2>() / static_cast<double>(idx.size());
  Eigen::Matrix2d scatter = Eigen::Matrix2d::Zero();
  for (const int i : idx) {
    const Eigen::Vector2d away = corners_board[static_cast<std::size_t>(i)].head<2>() - mean;
    scatter += away * away.transpose();
  }
  const Eigen::Vector2d spread = Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d>(scatter).eigenvalues();
  return !(spread[0] > kLineRatio * kLineRatio * spread[1]);
}

}  // namespace

std::size_t CornersMin(const Target& board) {
  constexpr std::size_t kOfTag = 4, kOfBoard = 6;
  return IsTagGrid(board.kind) && MarkerCountOf(board) == 1 ? kOfTag : kOfBoard;
}

std::string WhyUnusable(const BoardView& view, const Target& board) {
  if (!view.found) return view.why_not.empty() ? "no board" : view.why_not;
  const std::vector<Eigen::Vector3d> corners_board = TargetPoints(board);
  const std::vector<int>& idx = view.corner_idx;
  const int count = static_cast<int>(corners_board.size());
  const bool ascending = std::adjacent_find(idx.begin(), idx.end(), std::greater_equal<>()) == idx.end();
  if (idx.size() != view.corners_px.size() || !ascending || (!idx.empty() && (idx.front() < 0 || idx.back() >= count)))
    return "the points found are not those of target '" + board.id.str() + "'";
  if (!std::all_of(view.corners_px.begin(), view.corners_px.end(), [](const auto& uv_px) { return uv_px.allFinite(); }))
    return "a corner has no finite place in the picture";
  if (idx.size() < CornersMin(board))
    return "only " + std::to_string(idx.size()) + " points of the target are seen; at least " +
           std::to_string(CornersMin(board)) + " are needed";
  if (OnOneLine(idx, corners_board)) return "the points of the target that are seen lie on one line";
  return {};
}

SeenCorners SeenIn(const BoardView& view, const Target& board, int turn) {
  SeenCorners seen{view.corner_idx, view.corners_px};
  if (turn != 0)
    for (int& idx : seen.idx) idx = TurnedIndex(board, idx, turn);
  return seen;
}

}  // namespace rigcal::calib
