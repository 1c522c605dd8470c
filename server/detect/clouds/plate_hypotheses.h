// Places of a cloud where a plate may be: flat, large enough, and without a plane around.
#pragma once

#include <vector>

#include "server/detect/clouds/flat_patch.h"
#include "server/detect/clouds/plate_outline.h"

namespace rigcal::detect {

struct PlateHypothesis {
  FittedPlane plane;
  Eigen::Vector3d middle_m = Eigen::Vector3d::Zero();  // of the surface there, on the plane
  double promise = 0.0;                                // how well an outline laid roughly over it agrees, at most 1
};

constexpr std::size_t kHypothesesMax = 48;

// The most promising first, none twice. `rays` is indexed for balls of half the plate's short side.
[[nodiscard]] std::vector<PlateHypothesis> PlateHypotheses(const CloudRays& rays, const PlateSize& size);

}  // namespace rigcal::detect
