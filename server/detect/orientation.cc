#include "server/detect/orientation.h"

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

}  // namespace

Result<Corners> Oriented(const GreyImage& image, int inner_cols, int inner_rows, const Corners& corners) {
  const Grid grid{inner_cols, inner_rows};
  const int cells = (grid.cols - 1) * (grid.rows - 1);
  const int handedness = Handedness(corners, grid);
  if (std::abs(handedness) != cells)
    return Fail(ErrorCode::kInvalidInput, "the corners found do not form rows and columns", "take the picture again");
  Corners ordered = handedness > 0 ? corners : Mirrored(corners, grid);
  const double dark = FirstSquareDark(image, ordered, grid);
  if (std::abs(dark) < kAlternatingRatio)
    return Fail(ErrorCode::kInvalidInput, "the squares found do not alternate between dark and light",
                "take the picture again with even light and nothing in front of the board");
  // Half a turn keeps the hand and, with one odd and one even count, exchanges dark and light.
  if (dark < 0) std::reverse(ordered.begin(), ordered.end());
  return ordered;
}

}  // namespace rigcal::detect
