// A placement as lines: the board in a camera's picture, and rig and board from above.
#pragma once

#include <vector>

#include "server/calib/placement/next_placement.h"

namespace rigcal::companion {

// Pixels of the pattern's border, clockwise from its top left as printed, eight to a side: a lens bends them. Points
// that the camera cannot see are left out.
[[nodiscard]] std::vector<Eigen::Vector2d> OutlineInPicture(const calib::placement::PlannedCamera& camera,
                                                            const Target& board, const Se3& T_camera_board);

// In the plane of the reference camera's x (right) and z (ahead), metres.
struct FromAbove {
  struct Camera {
    SensorId id;
    std::vector<Eigen::Vector2d>
        view_m;  // where it sits, and the ends of 0.3 m along the left and right border of its view
  };
  std::vector<Camera> cameras;
  std::vector<Eigen::Vector2d> board_m;  // the four corners of its pattern
};
[[nodiscard]] FromAbove DrawFromAbove(const calib::placement::PlannedRig& rig,
                                      const calib::placement::NextPlacement& next);

}  // namespace rigcal::companion
