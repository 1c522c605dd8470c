// A camera whose intrinsics were given with sigmas, with one thing changed: intrinsics and board poses follow to first
// order, as changes are small against what the sigmas allow.
#pragma once

#include <set>

#include "server/calib/camera/intrinsics.h"

namespace rigcal::calib {

// `estimate.pull` pulls. The view's own pose is gone too.
[[nodiscard]] CameraEstimate WithoutViews(const CameraEstimate& estimate, const std::set<CaptureId>& captures);
// What the errors of the corners do to refined or estimated intrinsics: independent changes of one sigma each.
[[nodiscard]] std::vector<IntrinsicsVector> ChangesByCorners(const CameraEstimate& estimate);
[[nodiscard]] CameraEstimate WithIntrinsicsMoved(const CameraEstimate& estimate, const IntrinsicsVector& change);
// The intrinsic with that index given larger by so many of its sigmas.
[[nodiscard]] CameraEstimate WithGiven(const CameraEstimate& estimate, int idx, double sigmas);

}  // namespace rigcal::calib
