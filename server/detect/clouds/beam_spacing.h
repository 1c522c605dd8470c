// How densely a lidar samples one place.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "server/detect/clouds/flat_patch.h"

namespace rigcal::detect {

// Steps between neighbouring beams on a plane, as vectors of its frame: from one scan line to the next, and along a
// line. Where there are no lines (solid state) both are as long as the mean spacing.
struct BeamSpacing {
  Eigen::Vector2d across_m = Eigen::Vector2d::Zero(), along_m = Eigen::Vector2d::Zero();

  // The widest gap that the sampling leaves in the direction (unit).
  [[nodiscard]] double Along_m(const Eigen::Vector2d& direction) const {
    return std::abs(direction.dot(across_m)) + std::abs(direction.dot(along_m));
  }
};

// From rays that pierce the plane about the frame's origin, at least two.
[[nodiscard]] BeamSpacing SpacingOf(const CloudRays& rays, const std::vector<std::uint32_t>& indices,
                                    const FittedPlane& plane, const PlaneFrame& frame);

}  // namespace rigcal::detect
