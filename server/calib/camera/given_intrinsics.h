// Intrinsics that were given with their sigmas: known beforehand, and refined by the views within that.
#pragma once

#include <vector>

#include "server/calib/camera/projection.h"
#include "server/model/sessions/session.h"

namespace rigcal::calib {

constexpr double kTypicalCornerSigma_px = 0.25;  // until residuals say better

// Given without a sigma they are held; given with sigmas they are refined, except those of sigma 0; absent ones are
// estimated.
[[nodiscard]] bool RefinesIntrinsics(const Sensor& camera);
[[nodiscard]] bool HoldsIntrinsics(const Sensor& camera);

// What pulls refined intrinsics towards where they were given, against corners of `corner_sigma_px`.
struct IntrinsicsPull {
  IntrinsicsVector given = IntrinsicsVector::Zero(), sigma = IntrinsicsVector::Zero();  // sigma 0: held
  double corner_sigma_px = 0;                                                           // 0: nothing pulls

  [[nodiscard]] bool Pulls() const { return corner_sigma_px > 0; }  // false: the intrinsics are not refined
  // Of the residual given - estimated, in px.
  [[nodiscard]] double Weight(int idx) const { return sigma[idx] > 0 ? corner_sigma_px / sigma[idx] : 0.0; }
};
// Nothing that pulls, unless the camera's intrinsics are refined. No corner is taken to be better than 0.01 px.
[[nodiscard]] IntrinsicsPull PullOf(const Sensor& camera, double corner_sigma_px);
// Indices of refined intrinsics that stay as given.
[[nodiscard]] std::vector<int> HeldOf(const Sensor& camera);
// Indices of the others, ascending.
[[nodiscard]] std::vector<int> RefinedOf(const Sensor& camera);

}  // namespace rigcal::calib
