#include "server/detect/checkerboard/saddle_grid.h"

#include <algorithm>
#include <climits>
#include <cmath>

#include "server/detect/checkerboard/grid_outliers.h"
#include "server/detect/checkerboard/grid_prediction.h"

namespace rigcal::detect {
namespace {

constexpr float kSearchRatio = 0.22f, kSearchMin_px = 1.5f, kSearchMax_px = 8;  // around a predicted place
constexpr float kContrastRatio = 0.25f;                                         // of the neighbours'

// Everything that hangs together with `seed`.
SaddleGrid GridFrom(const std::vector<Saddle>& saddles, const std::vector<Neighbours>& neighbours, std::size_t seed,
                    std::vector<bool>& taken) {
  SaddleGrid grid;
  std::vector<std::pair<std::size_t, GridPlace>> open = {{seed, {0, 0}}};
  grid[{0, 0}] = {saddles[seed], 0};
  taken[seed] = true;
  for (std::size_t next = 0; next < open.size(); ++next) {
    const auto [index, place] = open[next];
    const std::size_t turn = grid.at(place).turn;
    for (std::size_t way = 0; way < 4; ++way) {
      if (neighbours[index][way] == kNoNeighbour) continue;
      const auto other = static_cast<std::size_t>(neighbours[index][way]);
      const GridPlace there = Stepped(place, way + turn);
      if (taken[other] || grid.contains(there)) continue;
      const std::size_t back = WayAlong(saddles[other], saddles[index].at_px - saddles[other].at_px);
      grid[there] = {saddles[other], (way + turn + 2 + 4 - back) % 4};
      taken[other] = true;
      open.emplace_back(other, there);
    }
  }
  return grid;
}

// How the saddle point would be turned in the grid; nothing if it is of the wrong kind for its place.
std::optional<std::size_t> TurnOf(const GreyLevel& level, const SaddleGrid& grid, const GridPlace& place,
                                  const Saddle& saddle) {
  for (std::size_t way = 0; way < 4; ++way) {
    const GridNode* neighbour = At(grid, Stepped(place, way));
    if (!neighbour) continue;
    const Saddle& other = neighbour->saddle;
    if (saddle.contrast < kContrastRatio * other.contrast) continue;
    const std::size_t own = WayAlong(saddle, other.at_px - saddle.at_px);
    if (!EdgeBetween(level, saddle, own, other)) continue;
    const std::size_t back = WayAlong(other, saddle.at_px - other.at_px);
    if ((back + neighbour->turn) % 4 != (way + 2) % 4) continue;
    return (way + 4 - own) % 4;
  }
  return std::nullopt;
}

std::optional<GridNode> Grown(const GreyLevel& level, const SaddleGrid& grid, const GridPlace& place) {
  const auto at_px = Predicted(grid, place);
  if (!at_px || !(at_px->x() >= 0 && at_px->y() >= 0 && at_px->x() <= static_cast<float>(level.width_px - 1) &&
                  at_px->y() <= static_cast<float>(level.height_px - 1)))
    return std::nullopt;
  const float spacing_px = Spacing_px(grid, place, *at_px);
  if (!(spacing_px >= 4 && spacing_px < HUGE_VALF)) return std::nullopt;
  const float radius_px = std::clamp(kSearchRatio * spacing_px, kSearchMin_px, kSearchMax_px);
  const auto saddle = SaddleNear(level, *at_px, radius_px);
  if (!saddle) return std::nullopt;
  const auto turn = TurnOf(level, grid, place, *saddle);
  if (!turn) return std::nullopt;
  return GridNode{*saddle, *turn};
}

// Is there a node at the next place that way, and the edge to it?
bool Joined(const GreyLevel& level, const SaddleGrid& grid, const GridPlace& place, std::size_t way) {
  const GridNode *from = At(grid, place), *to = At(grid, Stepped(place, way));
  return from && to && EdgeBetween(level, from->saddle, (way + 4 - from->turn) % 4, to->saddle);
}

// First and last of the rows or columns whose corners are joined often enough.
std::pair<int, int> Trimmed(const std::vector<int>& joined) {
  const int full = *std::max_element(joined.begin(), joined.end());
  int first = 0, last = static_cast<int>(joined.size()) - 1;
  const auto sparse = [&](int i) { return 3 * joined[static_cast<std::size_t>(i)] < full; };
  while (first < last && sparse(first)) ++first;
  while (last > first && sparse(last)) --last;
  return {first, last};
}

}  // namespace

std::vector<SaddleGrid> GridsOf(const std::vector<Saddle>& saddles, const std::vector<Neighbours>& neighbours,
                                std::size_t count_min) {
  std::vector<SaddleGrid> grids;
  std::vector<bool> taken(saddles.size(), false);
  for (std::size_t seed = 0; seed < saddles.size(); ++seed) {
    if (taken[seed] || neighbours[seed] == Neighbours{kNoNeighbour, kNoNeighbour, kNoNeighbour, kNoNeighbour}) continue;
    SaddleGrid grid = GridFrom(saddles, neighbours, seed, taken);
    if (grid.size() >= count_min) grids.push_back(std::move(grid));
  }
  std::stable_sort(grids.begin(), grids.end(),
                   [](const SaddleGrid& a, const SaddleGrid& b) { return a.size() > b.size(); });
  return grids;
}

void Grow(const GreyLevel& level, std::size_t count_max, SaddleGrid& grid) {
  DropGridOutliers(grid);
  std::vector<GridPlace> open;
  for (const auto& [place, node] : grid) open.push_back(place);
  for (std::size_t next = 0; next < open.size() && grid.size() < count_max; ++next)
    for (std::size_t way = 0; way < 4; ++way) {
      const GridPlace place = Stepped(open[next], way);
      if (grid.contains(place)) continue;
      if (const auto node = Grown(level, grid, place)) {
        grid[place] = *node;
        open.push_back(place);
      }
    }
}

GridBox BoxOf(const GreyLevel& level, const SaddleGrid& grid) {
  if (grid.empty()) return {0, -1, 0, -1};
  GridBox box{INT_MAX, INT_MIN, INT_MAX, INT_MIN};
  for (const auto& [place, node] : grid) {
    box.col_min = std::min(box.col_min, place.first), box.col_max = std::max(box.col_max, place.first);
    box.row_min = std::min(box.row_min, place.second), box.row_max = std::max(box.row_max, place.second);
  }
  std::vector<int> cols(static_cast<std::size_t>(box.Cols()), 0), rows(static_cast<std::size_t>(box.Rows()), 0);
  for (const auto& [place, node] : grid) {
    if (Joined(level, grid, place, 0)) ++rows[static_cast<std::size_t>(place.second - box.row_min)];
    if (Joined(level, grid, place, 1)) ++cols[static_cast<std::size_t>(place.first - box.col_min)];
  }
  const auto [col_first, col_last] = Trimmed(cols);
  const auto [row_first, row_last] = Trimmed(rows);
  return {box.col_min + col_first, box.col_min + col_last, box.row_min + row_first, box.row_min + row_last};
}

}  // namespace rigcal::detect
