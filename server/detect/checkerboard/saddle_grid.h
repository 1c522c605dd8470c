// Saddle points in rows and columns.
#pragma once

#include <map>
#include <optional>
#include <utility>
#include <vector>

#include "server/detect/checkerboard/saddle_links.h"

namespace rigcal::detect {

// `turn`: way i of the saddle points along way (i + turn) % 4 of the grid, whose ways are right, down, left, up.
struct GridNode {
  Saddle saddle;
  std::size_t turn = 0;
};

using GridPlace = std::pair<int, int>;  // column, row; counted from anywhere
using SaddleGrid = std::map<GridPlace, GridNode>;

// Of at least `count_min` saddle points that hang together; the largest first.
[[nodiscard]] std::vector<SaddleGrid> GridsOf(const std::vector<Saddle>& saddles,
                                              const std::vector<Neighbours>& neighbours, std::size_t count_min);
// Adds the saddle points that are where the grid says, inside it and around it, until there are no more or
// `count_max`. So a grid that cannot be grown is the whole of its pattern, as far as it is seen.
void Grow(const GreyLevel& level, std::size_t count_max, SaddleGrid& grid);

// Smallest and largest column and row.
struct GridBox {
  int col_min = 0, col_max = 0, row_min = 0, row_max = 0;
  // How many columns and rows; whether a place is among them.
  [[nodiscard]] int Cols() const { return col_max - col_min + 1; }
  [[nodiscard]] int Rows() const { return row_max - row_min + 1; }
  [[nodiscard]] bool Has(const GridPlace& place) const {
    return place.first >= col_min && place.first <= col_max && place.second >= row_min && place.second <= row_max;
  }
};
// Without the outer rows and columns along which less than a third of the edges are there: clutter that touches the
// board.
[[nodiscard]] GridBox BoxOf(const GreyLevel& level, const SaddleGrid& grid);

}  // namespace rigcal::detect
