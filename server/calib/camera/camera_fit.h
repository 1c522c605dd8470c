// What an estimate says of its cameras, corner by corner: for reports, after the answer.
#pragma once

#include <map>

#include "server/calib/camera/intrinsics.h"
#include "server/model/sensors/camera_fit.h"

namespace rigcal::calib {

// Views of a camera with the board where an estimate puts it. `turns`: how the corners of a view are renumbered, as
// StereoEstimate::turn_b. Views without a pose are left out. Estimated intrinsics get a sigma by a jackknife over the
// views (one Gauss-Newton step each), the model's below 5 views; given ones the sigma that was given with them,
// refined ones that of the views and what was given together.
[[nodiscard]] CameraFit FitOf(const CameraProblem& problem, const CameraIntrinsics& intrinsics,
                              const std::map<CaptureId, Se3>& T_cam_board, const std::map<CaptureId, int>& turns = {});
// Where the board was found, of a camera that was not solved.
[[nodiscard]] CameraFit SeenBy(const CameraProblem& problem);

// The former of an estimate; without: the latter.
[[nodiscard]] CameraFit FitOrSeen(const CameraProblem& problem, const CameraEstimate* camera);

}  // namespace rigcal::calib
