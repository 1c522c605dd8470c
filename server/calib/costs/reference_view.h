// Reprojection of one board view in camera a. Blocks: intrinsics of a [9], T_a_board [7]. Residuals in px: projected
// minus seen, u and v of every corner in turn.
#pragma once

#include <Eigen/Core>
#include <memory>
#include <vector>

namespace ceres {
class CostFunction;
}

namespace rigcal::calib {

// Keeps references to both lists, of equal length. Evaluation fails where a corner is not in front of the camera.
[[nodiscard]] std::unique_ptr<ceres::CostFunction> MakeReferenceViewCost(
    const std::vector<Eigen::Vector3d>& corners_board, const std::vector<Eigen::Vector2d>& corners_px);

}  // namespace rigcal::calib
