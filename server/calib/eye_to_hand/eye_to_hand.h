// A camera that stands beside a robot and sees the board on its flange (eye-to-hand). With F_k = T_base_flange the
// robot's pose, X = T_base_cam, Z = T_flange_board and B_k = T_board_cam: F_k Z = X B_k^-1, so F_k^-1 X = Z B_k, which
// is hand-eye (motion/hand_eye.h, Park & Martin 1994, Shah 2013) with the roles exchanged: as the flange sees it, base
// and camera are one rigid body that moves before a board that stands still.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "server/calib/motion/hand_eye.h"
#include "server/model/edges/edge.h"
#include "server/model/sensors/camera_fit.h"

namespace rigcal::calib {

struct EyeToHandEstimate {
  Se3 T_a_b;           // T_base_cam, or T_cam_base where the camera is a
  Se3 T_flange_board;  // told beside it
  MotionReach reach;   // of the base as the flange sees it; axes in frame a
  SideNoise noise_a, noise_b;
  std::map<CaptureId, double> rms_px;  // of captures used: corners against where the robot's pose has them
  double all_rms_px = 0.0;             // of all those corners; sqrt(sum of squared distances / number of points)
  double motion_rms_m = 0.0, motion_rms_rad = 0.0;  // of Log((Z B_k)^-1 F_k^-1 X)
  std::map<CaptureId, std::string> unused;          // why, in words
  std::optional<BoardScale> board_scale;            // where the robot's metres tell it
};

struct EyeToHandResult {
  EyeToHandEstimate estimate;
  Uncertainty uncertainty;       // right tangent at b
  std::vector<Diagnosis> notes;  // what stays open, by axis; captures that contradict
  CameraEstimate camera;         // from its pictures alone
};

// `problem`: one side the camera with its views of the board on the flange, the other the tracker with T_base_flange,
// which stands for the robot's base; T_a_b_nominal of camera and base. Pure; deterministic.
[[nodiscard]] OrDiagnosis<EyeToHandResult> EstimateEyeToHand(const HandEyeProblem& problem);
// The finished edge (method "eye_to_hand", residuals in px); a failed one carries the diagnoses, and before them
// "board_stands_still" where the poses fit a board that does. Throws where there is no memory, else never. `fits`, if
// not null, becomes what it says of the camera (camera_fit.h).
[[nodiscard]] Edge EstimateEyeToHandEdge(const HandEyeProblem& problem, std::vector<CameraFit>* fits = nullptr);
// EstimateHandEyeEdge() of a camera and a tracker; where it fails and the poses fit a board that moves with the
// tracker, "board_on_flange" says so before everything else.
[[nodiscard]] Edge EstimateTrackerCameraEdge(const HandEyeProblem& problem, std::vector<CameraFit>* fits = nullptr);

}  // namespace rigcal::calib
