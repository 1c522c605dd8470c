// One camera's lens as the refinement of a whole session finds it, together with all sensors' poses.
#pragma once

#include <Eigen/Core>

#include "server/base/ids.h"
#include "server/model/sensors/camera.h"

namespace rigcal {

struct RefinedLens {
  SensorId camera;
  CameraIntrinsics intrinsics;
  // Of fx fy cx cy and the distortion's values, in its order; zero for what was held.
  Eigen::MatrixXd covariance;
};

}  // namespace rigcal
