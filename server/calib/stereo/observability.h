// How well the focal length of a camera can be known from its views, before anything is solved.
#pragma once

#include <optional>

#include "server/base/ids.h"
#include "server/calib/camera/camera_start.h"
#include "server/model/diagnosis.h"

namespace rigcal::calib {

// The diagnosis if the focal length would be too uncertain.
[[nodiscard]] std::optional<Diagnosis> WhyNoTilt(const SensorId& camera, const CameraViews& views);

// After solving: the diagnosis if the views leave a distortion open. `variances` of the intrinsics. Judged by what a
// sigma of each coefficient does at the outermost corner seen, against the polynomial it is a part of: far more than
// the lens itself means that only sums of coefficients are known; of a sphere model, whose numbers have narrow ranges,
// by these. Never for the radtan model, whose focal length goes first (WhyNoTilt).
[[nodiscard]] std::optional<Diagnosis> WhyDistortionOpen(const SensorId& camera, CameraModel model,
                                                         const Eigen::VectorXd& variances, const CameraViews& views,
                                                         const IntrinsicsVector& intrinsics);

}  // namespace rigcal::calib
