// Places where four squares meet: dark and light quarters around a point, opposite ones alike.
#pragma once

#include <Eigen/Core>
#include <array>
#include <optional>
#include <vector>

#include "server/detect/pictures/grey_level.h"

namespace rigcal::detect {

// Pixels are the level's. `ways`: unit vectors from the point along its four edges, clockwise in the picture. Turning
// clockwise over ways 0 and 2 it goes from dark to light, over 1 and 3 from light to dark. Along an edge of a board the
// two kinds take turns from corner to corner.
struct Saddle {
  Eigen::Vector2f at_px = Eigen::Vector2f::Zero();
  std::array<Eigen::Vector2f, 4> ways;
  float contrast = 0;  // grey levels between the light and the dark quarters
};

// Row by row. Squares from about 7 pixels. The response is that of Bennett & Lasenby, "ChESS - quick and robust
// detection of chess-board features" (2014): a ring of 16 pixels, whole numbers only.
[[nodiscard]] std::vector<Saddle> SaddlePoints(const GreyLevel& level);

// The best one at most `radius_px` away from a place where one is expected: a weaker response will do.
[[nodiscard]] std::optional<Saddle> SaddleNear(const GreyLevel& level, const Eigen::Vector2f& at_px, float radius_px);

}  // namespace rigcal::detect
