// Where a grid of saddle points expects the next one.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <optional>

#include "server/detect/checkerboard/saddle_grid.h"

namespace rigcal::detect {

// `way`: right, down, left, up, and round again.
[[nodiscard]] GridPlace Stepped(const GridPlace& from, std::size_t way, int times = 1);
// Null: nothing there.
[[nodiscard]] const GridNode* At(const SaddleGrid& grid, const GridPlace& place);

// The mean of what the lines and the cells next to the place say. It looks at places up to three steps away in rows and
// columns, and one step diagonally. Nothing if they do not say.
[[nodiscard]] std::optional<Eigen::Vector2f> Predicted(const SaddleGrid& grid, const GridPlace& place);
// From `at_px` to the nearest of the four nodes next to the place; infinite without any.
[[nodiscard]] float Spacing_px(const SaddleGrid& grid, const GridPlace& place, const Eigen::Vector2f& at_px);

}  // namespace rigcal::detect
