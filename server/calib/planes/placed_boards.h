// The boards of one camera's views under given intrinsics.
#pragma once

#include "server/calib/camera/camera_start.h"

namespace rigcal::calib {

struct PlacedBoards {
  JointProblem joint;  // with the intrinsics to be estimated
  JointState state;
  double cost_px2 = 0;
};

// The poses of all boards, refined with the intrinsics held. A view that no pose explains leaves the problem.
[[nodiscard]] PlacedBoards PlaceBoards(const CameraViews& views, const IntrinsicsVector& intrinsics);

}  // namespace rigcal::calib
