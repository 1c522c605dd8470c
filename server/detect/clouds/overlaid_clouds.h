// The picture of two lidars' clouds on top of each other, for reports.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "server/math/se3.h"

namespace rigcal::detect {

// JPEG: from above (along a's z), a's cloud in blue and b's in orange; left with the pose as it was given, right with
// the one found. The same input gives the same bytes. Throws what OpenCV throws.
[[nodiscard]] std::string OverlaidClouds(const std::vector<Eigen::Vector3f>& a_m,
                                         const std::vector<Eigen::Vector3f>& b_m, const Se3& T_a_b_before,
                                         const Se3& T_a_b_after);

}  // namespace rigcal::detect
