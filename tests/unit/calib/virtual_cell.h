// A robot that carries a board before a camera beside it, with known truth. Nothing of the estimator is used.
#pragma once

#include "tests/unit/calib/virtual_motion.h"

namespace rigcal::calib {

struct VirtualCell {
  Se3 T_base_cam, T_flange_board;
  std::vector<Se3> T_base_flange;  // one per capture
};
// kAll: the flange turns to all sides. kOneAxis: about one axis of the base alone. kFirstJoint: the whole arm about the
// base's z. kNoTurns: moved only. The board stays in view at 1.2 to 2 m.
enum class Arm { kAll, kOneAxis, kFirstJoint, kNoTurns };
[[nodiscard]] VirtualCell Celled(const VirtualView& view, Arm arm, int captures, unsigned seed);

// Tracker "arm" (T_base_flange with noise) as a, camera "camera" as b; `given`: with its true intrinsics.
[[nodiscard]] HandEyeProblem ArmAndCamera(const VirtualCell& cell, const VirtualView& view, const PoseNoise& arm,
                                          bool given, unsigned seed);

}  // namespace rigcal::calib
