// How somebody is told to hold a board before a camera, and the board's pose that this is.
#pragma once

#include "server/math/se3.h"
#include "server/model/sensors/target.h"

namespace rigcal::calib::placement {

// As it is told to a person who looks along with the camera.
struct Stand {
  double right_rad = 0.0, up_rad = 0.0;  // of the line of sight to the board's middle against the camera's axis
  double distance_m = 0.0;               // from the camera to the board's middle
  // Of the board against facing the camera; positive: its right, its upper side is nearer to the camera.
  double tilt_right_rad = 0.0, tilt_up_rad = 0.0;
  double turned_rad = 0.0;  // in its own plane, clockwise as the camera sees it; 0: upright in the picture
};

// T_camera_board of a board that stands so; and the stand of a board, of its middle.
[[nodiscard]] Se3 PoseOf(const Stand& stand, const Target& board);
[[nodiscard]] Stand StandOf(const Se3& T_camera_board, const Target& board);

// From upright or upside down, 0, to on its side, a quarter turn.
[[nodiscard]] double TurnedAside_rad(const Stand& stand);
// A hand's breadth and some degrees apart: errors of corners are alike in both. Upside down is as upright.
[[nodiscard]] bool AreAlike(const Stand& a, const Stand& b);

}  // namespace rigcal::calib::placement
