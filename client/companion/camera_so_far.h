// One camera as far as it can be planned with, and where it saw its board.
#pragma once

#include <map>
#include <optional>
#include <vector>

#include "client/companion/captured.h"
#include "server/calib/placement/planned_rig.h"

namespace rigcal::companion {

// Without its pose: lens as given, as estimated so far, or a guess; noise by its residuals. Nothing where neither its
// lens nor any picture is known.
[[nodiscard]] std::optional<calib::placement::PlannedCamera> PlannedCameraOf(const SessionHeader& header,
                                                                             const Sensor& sensor,
                                                                             const CameraSoFar& so_far);

struct BoardSeen {
  Se3 T_camera_board;
  std::vector<int> corner_idx;
  std::vector<Se3> other_poses = {};  // that fit almost as well
};
// Of the board that it saw most. By a lens that its pictures do not tell yet, roughly.
[[nodiscard]] std::map<CaptureId, BoardSeen> BoardsSeenBy(const Captured& captured,
                                                          const calib::placement::PlannedCamera& camera);

}  // namespace rigcal::companion
