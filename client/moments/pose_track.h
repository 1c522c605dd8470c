// Where the board was before one camera, over time: of what a stream's pictures show of it.
#pragma once

#include <optional>
#include <vector>

#include "client/moments/sight.h"
#include "server/math/se3.h"
#include "server/model/sessions/session.h"

namespace rigcal::moments {

struct TimedPose {
  double t_s = 0;  // of the camera's clock, since `begin_ns`
  Se3 T_cam_board;
};

// By time, of the sights that show `targets[target_idx]`. The lens is the camera's, or where it has none estimated of
// some tens of its sights; without a lens, or where that board was not seen, nothing. Of two poses that a small board
// allows, the one nearer to that before it.
[[nodiscard]] std::vector<TimedPose> PosesOf(const Sensor& camera, const Target& target, int target_idx,
                                             const std::vector<Sight>& sights, std::int64_t begin_ns);

}  // namespace rigcal::moments
