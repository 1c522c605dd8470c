// A camera whose intrinsics were given with sigmas, with one thing changed: intrinsics and board poses follow to first
// order, as changes are small against what the sigmas allow.
#pragma once

#include "server/calib/intrinsics.h"

namespace rigcal::calib {

// `estimate.pull` pulls. The view's own pose is gone too.
[[nodiscard]] CameraEstimate WithoutView(const CameraEstimate& estimate, const CaptureId& capture);
// The intrinsic with that index given larger by so many of its sigmas.
[[nodiscard]] CameraEstimate WithGiven(const CameraEstimate& estimate, int idx, double sigmas);

}  // namespace rigcal::calib
