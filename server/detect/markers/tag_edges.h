// The corners of a tag from its edges.
#pragma once

#include <Eigen/Core>
#include <array>
#include <optional>

#include "server/detect/pictures/grey_image.h"

namespace rigcal::detect {

// Where the edges of the tag with about these corners meet: corners alone are rounded by blur, edges are not moved by
// it. The edges of larger tags may be bent by the lens. `clear_ratio`: how far from an edge, as a part of the side,
// nothing else is printed. Nothing for a corner of which an edge is not plain to see, or that is more than a tenth of
// the side (and 2.5 px) off.
[[nodiscard]] std::array<std::optional<Eigen::Vector2d>, 4> SharpCorners(
    const GreyImage& image, const std::array<Eigen::Vector2d, 4>& corners_px, double clear_ratio);

}  // namespace rigcal::detect
