// Starting values of a fisheye's intrinsics: fields of view are tried.
#pragma once

#include "server/calib/camera/camera_start.h"

namespace rigcal::calib {

// The equidistant lens (f = longer side / field of view, principal point in the middle) whose board poses reproject
// best.
[[nodiscard]] IntrinsicsVector RoughFisheye(const CameraViews& views);

}  // namespace rigcal::calib
