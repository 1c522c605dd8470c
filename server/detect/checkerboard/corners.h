// Searches the inner corners of a checkerboard.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "server/detect/pictures/grey_image.h"

namespace rigcal::detect {

// Row-major, sub-pixel, in an order that still needs Oriented(). Empty: no board of these counts was found.
// Throws what OpenCV throws.
[[nodiscard]] std::optional<std::vector<Eigen::Vector2d>> FindCorners(const GreyImage& image, int cols, int rows);

// The second half of it: each corner made exact in a window that stays clear of the next ones.
[[nodiscard]] std::vector<Eigen::Vector2d> RefinedCorners(const GreyImage& image, int cols, int rows,
                                                          const std::vector<Eigen::Vector2d>& corners);

}  // namespace rigcal::detect
