// The next placement, and how well things are known, in words for the person who holds the board.
#pragma once

#include <string>

#include "client/companion/rig_so_far.h"
#include "server/calib/placement/next_placement.h"

namespace rigcal::companion {

// "Hold the board 40 deg left of left_back at 3.0 m, tilted 30 deg to the right: z of left_back falls from 9.1 to 3.2
// mm." Angles off the camera's axis below 5 degrees are left out; left, right, up and down are those of its picture.
// Where there are several boards it names the one.
[[nodiscard]] std::string PlacementText(const calib::placement::PlannedRig& rig,
                                        const calib::placement::NextPlacement& next);
// "10 deg left and 5 deg up of front", "straight before front".
[[nodiscard]] std::string SightText(const calib::placement::Stand& stand, const std::string& camera);
// "tilted 30 deg to the right": that side is nearer to the camera; "facing it"; "on its side, facing it".
[[nodiscard]] std::string TiltText(const calib::placement::Stand& stand);
// "z", "turn about y".
[[nodiscard]] std::string AxisText(int axis);

}  // namespace rigcal::companion
