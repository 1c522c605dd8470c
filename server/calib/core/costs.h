// The costs of the joint problem of two cameras (Zhang 2000), analytic. Residuals in px; poses are blocks [p, q_xyzw]
// (pose_block.h), perturbed on the right: r = pi(K_c, p_c) - uv, dr/dxi of T_c_board = dpi/dp R [I, -[p_board]x].
#pragma once

#include <Eigen/Core>
#include <memory>
#include <vector>

#include "server/calib/camera/given_intrinsics.h"
#include "server/calib/camera/seen_corners.h"

namespace ceres {
class CostFunction;
}

namespace rigcal::calib {

// Reprojection of one board view: projected minus seen, u and v of every corner in turn. Both keep references to the
// lists; `seen` indexes `corners_board`. Evaluation fails where the camera cannot see a corner.
//
// In camera a. Blocks: intrinsics of a [IntrinsicsCount(model)], T_a_board [7].
[[nodiscard]] std::unique_ptr<ceres::CostFunction> MakeReferenceViewCost(
    CameraModel model, const std::vector<Eigen::Vector3d>& corners_board, const SeenCorners& seen);
// In camera b, through camera a: p_b = T_a_b^-1 T_a_board p_board. Blocks: intrinsics of b [IntrinsicsCount(model)],
// T_a_b [7], T_a_board [7].
[[nodiscard]] std::unique_ptr<ceres::CostFunction> MakeSecondViewCost(CameraModel model,
                                                                      const std::vector<Eigen::Vector3d>& corners_board,
                                                                      const SeenCorners& seen);

// How far refined intrinsics are from where they were given. Block: intrinsics [count]. Residuals: weight times the
// difference, one per intrinsic.
[[nodiscard]] std::unique_ptr<ceres::CostFunction> MakeGivenIntrinsicsCost(CameraModel model,
                                                                           const IntrinsicsPull& pull);

}  // namespace rigcal::calib
