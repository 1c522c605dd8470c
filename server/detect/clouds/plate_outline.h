// A rectangle of known size laid over the rays that pierce a plane: where it has a surface, and where it has none.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "server/detect/clouds/beam_spacing.h"
#include "server/detect/clouds/flat_patch.h"
#include "server/model/sensors/target.h"

namespace rigcal::detect {

// What is known of a plate's width and height, metres. Without a measured plate: from the pattern to two squares more.
struct PlateSize {
  Eigen::Vector2d min_m, max_m;

  // Width and height half-way between the two; the shorter of them; the diagonal.
  [[nodiscard]] Eigen::Vector2d Middle_m() const { return (min_m + max_m) / 2; }
  [[nodiscard]] double Short_m() const { return Middle_m().minCoeff(); }
  [[nodiscard]] double Diagonal_m() const { return Middle_m().norm(); }
};
// Of the measured plate, else of the pattern.
[[nodiscard]] PlateSize PlateSizeOf(const Target& target);

// In a plane's frame: the rectangle's middle, the direction of its width, its width and height.
struct Outline {
  Eigen::Vector2d centre_m = Eigen::Vector2d::Zero();
  double angle_rad = 0.0;
  Eigen::Vector2d size_m = Eigen::Vector2d::Zero();

  // Unit vector along the width.
  [[nodiscard]] Eigen::Vector2d Axis() const { return {std::cos(angle_rad), std::sin(angle_rad)}; }
  // Coordinates along width and height, from the middle.
  [[nodiscard]] Eigen::Vector2d Local(const Eigen::Vector2d& uv_m) const;
  // Distance to the nearest side's line, positive inside.
  [[nodiscard]] double Depth_m(const Eigen::Vector2d& uv_m) const;
};

// Surface inside, none outside, each edge midway between the two: the best position and turn (0 to 180 degrees) near
// the frame's origin; the same from an outline that is nearly right; a quick guess.
[[nodiscard]] Outline FindOutline(const std::vector<Piercing>& piercings, const PlateSize& size);
[[nodiscard]] Outline RefineOutline(const std::vector<Piercing>& piercings, const PlateSize& size,
                                    const Outline& start);
[[nodiscard]] Outline GuessOutline(const std::vector<Piercing>& piercings, const PlateSize& size);
// Surface inside over the outline and all surface, by count of rays: 0 to 1.
[[nodiscard]] double OverlapOf(const std::vector<Piercing>& piercings, const Outline& outline);

// How far inside the edge a point must lie to be none of the pixels that saw plate and background at once.
[[nodiscard]] double EdgeMargin_m(const Outline& outline, const BeamSpacing& spacing);
// 1: a plate, whole and free on every side; 0: none.
[[nodiscard]] double ScoreOf(const std::vector<Piercing>& piercings, const Outline& outline,
                             const BeamSpacing& spacing);

}  // namespace rigcal::detect
