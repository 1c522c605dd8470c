// A camera that looks at a board that stands still: its poses in the board's frame, with what they share.
#pragma once

#include <map>
#include <set>
#include <vector>

#include "server/calib/camera/intrinsics.h"
#include "server/calib/camera/projection.h"
#include "server/calib/camera/view_moments.h"
#include "server/calib/motion/motion_problem.h"

namespace rigcal::calib {

// A camera's views as side of a motion. Intrinsics that are estimated or refined are the side's shared parameters; the
// camera's pose in the frame of the board is T_world_sensor.
struct CameraMotion {
  CameraEstimate camera;
  bool estimates_intrinsics = false;
  int intrinsics_count = 0;
  // Per capture: the poses that its view allows, the likeliest first.
  std::map<CaptureId, std::vector<ViewMoments>> views;
  int turns = 1;                                             // orientations in which the board looks alike
  Eigen::Vector3d centre_board_m = Eigen::Vector3d::Zero();  // about which it is turned
};

// The camera by itself, then every pose of each view. The diagnosis is that of the camera's estimate; `solver` empty:
// EstimateCamera.
[[nodiscard]] OrDiagnosis<CameraMotion> CameraMotionOf(const CameraProblem& problem, const CameraSolver& solver);

// The pose and what the intrinsics do to it. `turn`: the board taken as turned by that many of its symmetric turns.
[[nodiscard]] SidePose PoseOf(const CameraMotion& motion, const ViewMoments& view, int turn);
// What all views but those `without` say of the intrinsics, each with the first of its poses, and what was
// given of them. `factor`: on the variance of corners.
void FillShared(const CameraMotion& motion, const std::map<CaptureId, std::size_t>& chosen,
                const std::set<CaptureId>& without, double factor, MotionSide& side);

}  // namespace rigcal::calib
