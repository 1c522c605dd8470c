// How one camera fits its pictures of one board: where corners were seen, how far they are from where the estimate puts
// them, how the boards stood. What a report draws of a camera.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "server/base/ids.h"
#include "server/model/sensors/camera.h"

namespace rigcal {

// One picture with the board in it.
struct ViewFit {
  CaptureId capture;
  std::vector<Eigen::Vector2d> uv_px;  // corners as seen
  // Seen minus where the estimate puts them, side by side with `uv_px`; empty: the board has no pose.
  std::vector<Eigen::Vector2d> residual_px;
  double distance_m = 0.0;  // of the board's middle; has a meaning with residuals only, as the next
  // The angle between the board's normal and the line of sight to its middle, along the picture's x (positive: its
  // right side is nearer) and y (its lower side is nearer).
  Eigen::Vector2d tilt_rad = Eigen::Vector2d::Zero();
};

// kRefined: given with sigmas, and refined by the views within those.
enum class IntrinsicsSource { kNone, kGiven, kRefined, kEstimated };  // "none" | "given" | "refined" | "estimated"

struct CameraFit {
  SensorId camera;
  int width_px = 0, height_px = 0;
  IntrinsicsSource source = IntrinsicsSource::kNone;
  CameraIntrinsics intrinsics;  // meaningful unless kNone
  // fx fy cx cy and the distortion's, in its order; empty: not known.
  std::vector<double> sigma;
  bool sigma_by_jackknife = false;  // false: given, or the model's
  // Of the same values in the same order: `sigma` is the square root of its diagonal. Without rows: not known, or none.
  Eigen::MatrixXd covariance;
  // How all boards together seem to have moved when the intrinsics change, as the corners see it: T_cam_board becomes
  // Exp(implied_motion * change) * T_cam_board. 6 rows (m, rad; axes of the camera), a column for each intrinsic. There
  // with `covariance`, else empty.
  Eigen::MatrixXd implied_motion;
  std::vector<ViewFit> views;
};

}  // namespace rigcal
