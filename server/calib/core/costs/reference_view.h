// Reprojection of one board view in camera a. Blocks: intrinsics of a [IntrinsicsCount(model)], T_a_board [7].
// Residuals in px: projected minus seen, u and v of every corner in turn.
#pragma once

#include <Eigen/Core>
#include <memory>
#include <vector>

#include "server/calib/camera/seen_corners.h"
#include "server/model/camera.h"

namespace ceres {
class CostFunction;
}

namespace rigcal::calib {

// Keeps references to both lists; `seen` indexes `corners_board`. Evaluation fails where the camera cannot see a
// corner.
[[nodiscard]] std::unique_ptr<ceres::CostFunction> MakeReferenceViewCost(
    CameraModel model, const std::vector<Eigen::Vector3d>& corners_board, const SeenCorners& seen);

}  // namespace rigcal::calib
