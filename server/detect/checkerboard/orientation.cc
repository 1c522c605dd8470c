#include "server/detect/checkerboard/orientation.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace rigcal::detect {
namespace {

using Corners = std::vector<Eigen::Vector2d>;

// A part of the squares may be hidden by glare or a finger; a wrong find alternates by chance only.
constexpr double kAlternatingRatio = 0.9;

struct Grid {
  int cols = 0, rows = 0;
  [[nodiscard]] std::size_t Index(int col, int row) const { return static_cast<std::size_t>(row * cols + col); }
};

double Cross(const Eigen::Vector2d& u, const Eigen::Vector2d& v) { return u.x() * v.y() - u.y() * v.x(); }

// Cells of which the columns x rows turn clockwise (+) or the other way (-).
int Handedness(const Corners& corners, const Grid& grid) {
  int balance = 0;
  for (int row = 0; row + 1 < grid.rows; ++row)
    for (int col = 0; col + 1 < grid.cols; ++col) {
      const Eigen::Vector2d& origin = corners[grid.Index(col, row)];
      const double area = Cross(corners[grid.Index(col + 1, row)] - origin, corners[grid.Index(col, row + 1)] - origin);
      balance += area > 0 ? 1 : -1;
    }
  return balance;
}

// Mean grey around the centre of a square: four points on its diagonals.
double SquareGrey(const GreyImage& image, const Corners& corners, const Grid& grid, int col, int row) {
  const Eigen::Vector2d around[4] = {corners[grid.Index(col, row)], corners[grid.Index(col + 1, row)],
                                     corners[grid.Index(col, row + 1)], corners[grid.Index(col + 1, row + 1)]};
  const Eigen::Vector2d centre = (around[0] + around[1] + around[2] + around[3]) / 4;
  double sum = 0;
  for (const Eigen::Vector2d& corner : around) {
    const Eigen::Vector2d point = centre + 0.4 * (corner - centre);
    const int x = std::clamp(static_cast<int>(std::lround(point.x())), 0, image.width_px - 1);
    const int y = std::clamp(static_cast<int>(std::lround(point.y())), 0, image.height_px - 1);
    sum += image.At(x, y);
  }
  return sum / 4;
}

// In -1 ... 1: +1 if every two neighbouring squares differ as they do on a board whose first square is dark, -1 if its
// first square is light. Neighbours only, so that shading across the board does not matter.
double FirstSquareDark(const GreyImage& image, const Corners& corners, const Grid& grid) {
  std::vector<double> grey;
  const Grid squares{grid.cols - 1, grid.rows - 1};
  for (int row = 0; row < squares.rows; ++row)
    for (int col = 0; col < squares.cols; ++col) grey.push_back(SquareGrey(image, corners, grid, col, row));
  int votes = 0, balance = 0;
  const auto vote = [&](int col, int row, std::size_t neighbour) {
    const double step = (grey[neighbour] - grey[squares.Index(col, row)]) * ((col + row) % 2 == 0 ? 1 : -1);
    balance += step > 0 ? 1 : (step < 0 ? -1 : 0);
    ++votes;
  };
  for (int row = 0; row < squares.rows; ++row)
    for (int col = 0; col < squares.cols; ++col) {
      if (col + 1 < squares.cols) vote(col, row, squares.Index(col + 1, row));
      if (row + 1 < squares.rows) vote(col, row, squares.Index(col, row + 1));
    }
  return votes == 0 ? 0.0 : static_cast<double>(balance) / votes;
}

Corners Mirrored(Corners corners, const Grid& grid) {
  for (int row = 0; row < grid.rows; ++row)
    std::reverse(corners.begin() + row * grid.cols, corners.begin() + (row + 1) * grid.cols);
  return corners;
}

// By a quarter of a turn; equal counts only.
Corners Turned(const Corners& corners, const Grid& grid) {
  Corners turned;
  for (int row = 0; row < grid.rows; ++row)
    for (int col = 0; col < grid.cols; ++col) turned.push_back(corners[grid.Index(row, grid.cols - 1 - col)]);
  return turned;
}

// The order, of `step` (in quarters) and its multiples, that starts closest to the picture's top left.
Corners FromTopLeft(const Corners& corners, const Grid& grid, int step) {
  Corners best = corners, turned = corners;
  for (int quarter = step; quarter < 4; quarter += step) {
    turned = step == 1 ? Turned(turned, grid) : Corners(turned.rbegin(), turned.rend());
    if (turned.front().sum() < best.front().sum()) best = turned;
  }
  return best;
}

}  // namespace

Result<Corners> Oriented(const GreyImage& image, int cols, int rows, const Corners& corners) {
  const Grid grid{cols, rows};
  const int cells = (grid.cols - 1) * (grid.rows - 1);
  const int handedness = Handedness(corners, grid);
  if (std::abs(handedness) != cells)
    return Fail(ErrorCode::kInvalidInput, "the corners found do not form rows and columns", "take the picture again");
  Corners ordered = handedness > 0 ? corners : Mirrored(corners, grid);
  const double dark = FirstSquareDark(image, ordered, grid);
  if (std::abs(dark) < kAlternatingRatio)
    return Fail(ErrorCode::kInvalidInput, "the squares found do not alternate between dark and light",
                "take the picture again with even light and nothing in front of the board");
  // Half a turn keeps the hand; it exchanges dark and light if one count is odd and one even. With equal odd counts a
  // quarter does.
  if (cols % 2 != rows % 2) {
    if (dark < 0) std::reverse(ordered.begin(), ordered.end());
    return ordered;
  }
  if (cols == rows && cols % 2 == 1 && dark < 0) ordered = Turned(ordered, grid);
  return FromTopLeft(ordered, grid, cols == rows && cols % 2 == 0 ? 1 : 2);
}

}  // namespace rigcal::detect
