#include "server/detect/checkerboard/grid_outliers.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "server/detect/checkerboard/grid_prediction.h"

namespace rigcal::detect {
namespace {

constexpr float kSpacing_px = 20;

SaddleGrid Regular(int cols, int rows) {
  SaddleGrid grid;
  for (int row = 0; row < rows; ++row)
    for (int col = 0; col < cols; ++col)
      grid[{col, row}].saddle.at_px = {kSpacing_px * static_cast<float>(col), kSpacing_px * static_cast<float>(row)};
  return grid;
}

std::vector<GridPlace> PlacesOf(const SaddleGrid& grid) {
  std::vector<GridPlace> places;
  for (const auto& [place, node] : grid) places.push_back(place);
  return places;
}

// The definition, word by word: looks at every node anew after each that it takes out.
void DropGridOutliersSlowly(SaddleGrid& grid) {
  while (true) {
    auto worst = grid.end();
    float worst_off = 0.3f;
    for (auto node = grid.begin(); node != grid.end(); ++node) {
      const auto told = Predicted(grid, node->first);
      const float off =
          told ? (*told - node->second.saddle.at_px).norm() / Spacing_px(grid, node->first, *told) : HUGE_VALF;
      if (off > worst_off) worst = node, worst_off = off;
    }
    if (worst == grid.end()) return;
    grid.erase(worst);
  }
}

TEST(DropGridOutliers, KeepsAGridWithoutAny) {
  SaddleGrid grid = Regular(9, 6);
  DropGridOutliers(grid);
  EXPECT_EQ(grid.size(), 54u);
}

TEST(DropGridOutliers, TakesOutTheOneThatIsOffOnly) {
  SaddleGrid grid = Regular(9, 6);
  grid[{4, 3}].saddle.at_px.x() += 0.45f * kSpacing_px;
  DropGridOutliers(grid);
  SaddleGrid expected = Regular(9, 6);
  expected.erase({4, 3});
  EXPECT_EQ(PlacesOf(grid), PlacesOf(expected));
}

TEST(DropGridOutliers, IsWhatLookingAtEveryNodeAnewGives) {
  for (unsigned seed = 1; seed <= 20; ++seed) {
    std::mt19937 random(seed);
    const auto uniform = [&] { return static_cast<float>(random() % 1000) / 1000 - 0.5f; };
    SaddleGrid grid = Regular(14, 11);
    for (auto node = grid.begin(); node != grid.end();) {
      node->second.saddle.at_px +=
          Eigen::Vector2f(uniform(), uniform()) * kSpacing_px * 0.06f * static_cast<float>(seed);
      node = random() % 5 == 0 ? grid.erase(node) : std::next(node);
    }
    SaddleGrid slowly = grid;
    DropGridOutliers(grid);
    DropGridOutliersSlowly(slowly);
    EXPECT_EQ(PlacesOf(grid), PlacesOf(slowly)) << "seed " << seed;
  }
}

}  // namespace
}  // namespace rigcal::detect
