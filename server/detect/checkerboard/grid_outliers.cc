#include "server/detect/checkerboard/grid_outliers.h"

#include <array>
#include <cmath>
#include <map>
#include <set>
#include <utility>

#include "server/detect/checkerboard/grid_prediction.h"

namespace rigcal::detect {
namespace {

constexpr float kOffMax = 0.3f;  // from a predicted place, in parts of the spacing

// All places whose prediction looks at this one; Predicted() looks the same way in all directions.
constexpr std::array<GridPlace, 16> kAround = {{{1, 0},
                                                {2, 0},
                                                {3, 0},
                                                {-1, 0},
                                                {-2, 0},
                                                {-3, 0},
                                                {0, 1},
                                                {0, 2},
                                                {0, 3},
                                                {0, -1},
                                                {0, -2},
                                                {0, -3},
                                                {1, 1},
                                                {1, -1},
                                                {-1, 1},
                                                {-1, -1}}};

// How far a node is from where the others say, in parts of the spacing there; infinite if they say nothing.
float Off(const SaddleGrid& grid, const GridPlace& place, const GridNode& node) {
  const auto told = Predicted(grid, place);
  return told ? (*told - node.saddle.at_px).norm() / Spacing_px(grid, place, *told) : HUGE_VALF;
}

// The nodes that are off, the worst first; of equal ones the first by place.
class GridOutliers {
 public:
  explicit GridOutliers(const SaddleGrid& grid) {
    for (const auto& [place, node] : grid) Judge(grid, place);
  }
  [[nodiscard]] bool empty() const { return worst_first_.empty(); }
  [[nodiscard]] GridPlace Worst() const { return worst_first_.begin()->second; }
  // Anew, after the grid changed there or around it.
  void Judge(const SaddleGrid& grid, const GridPlace& place) {
    if (const auto known = off_.find(place); known != off_.end()) {
      worst_first_.erase({-known->second, place});
      off_.erase(known);
    }
    const GridNode* node = At(grid, place);
    const float off = node ? Off(grid, place, *node) : 0.0f;
    if (!(off > kOffMax)) return;
    off_[place] = off;
    worst_first_.emplace(-off, place);
  }

 private:
  std::map<GridPlace, float> off_;
  std::set<std::pair<float, GridPlace>> worst_first_;
};

}  // namespace

void DropGridOutliers(SaddleGrid& grid) {
  GridOutliers outliers(grid);
  while (!outliers.empty()) {
    const GridPlace worst = outliers.Worst();
    grid.erase(worst);
    outliers.Judge(grid, worst);
    for (const auto& [cols, rows] : kAround) outliers.Judge(grid, {worst.first + cols, worst.second + rows});
  }
}

}  // namespace rigcal::detect
