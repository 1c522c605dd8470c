// Which way the surfaces of a scan face: so that a room can be looked into from outside.
#pragma once

#include <Eigen/Core>
#include <vector>

namespace rigcal::cloud {

// One unit vector per point, towards the lidar (the origin): of its surface; where several meet, along the ray; zero where
// there are too few points to say. Coarse: planes
// are fitted to bundles of neighbouring rays, at least `step_rad` apart.
[[nodiscard]] std::vector<Eigen::Vector3f> FacingOf(const std::vector<Eigen::Vector3f>& points_m, float step_rad);

}  // namespace rigcal::cloud
