// How far refined intrinsics are from where they were given. Block: intrinsics [count]. Residuals in px: weight times
// the difference, one per intrinsic.
#pragma once

#include <memory>

#include "server/calib/camera/given_intrinsics.h"

namespace ceres {
class CostFunction;
}

namespace rigcal::calib {

[[nodiscard]] std::unique_ptr<ceres::CostFunction> MakeGivenIntrinsicsCost(CameraModel model,
                                                                           const IntrinsicsPull& pull);

}  // namespace rigcal::calib
