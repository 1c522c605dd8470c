// From the middle of a circle's picture to the picture of its middle.
#pragma once

#include <Eigen/Core>
#include <vector>

namespace rigcal::detect {

// A tilted circle's near half looks larger than its far half, so the centroid of its picture is not where its centre
// is: by about radius_px^2 / focal length_px * sin(2 tilt) / 4, 0.1 px and more of a common board. The lens does so,
// too. Here the board's own map into this picture tells by how much, and it is taken off: a homography, a radial bend
// about the picture's middle and a cubic of what is left, all fitted to the circles themselves. No lens and no pose has
// to be known. `picture_px`: width and height. `board`: where the centres are on the board, `radius` in the
// same unit; side by side with `centroids_px`. At least four, no three of four on a line; else they stay as they are.
[[nodiscard]] std::vector<Eigen::Vector2d> CentresFrom(const std::vector<Eigen::Vector2d>& board, double radius,
                                                       const std::vector<Eigen::Vector2d>& centroids_px,
                                                       const Eigen::Vector2d& picture_px);

}  // namespace rigcal::detect
