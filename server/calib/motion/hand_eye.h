// Two sensors that ride on one rigid body and need not see the same thing: cameras before boards of their own, a camera
// and a tracker or a robot, two pose streams (paper, section III-A: non-overlapping camera pairs, tracking system). A_k
// X = Z B_k (Park & Martin 1994 and Shah 2013 for the start), the body's poses estimated too, one noise factor per side
// from the residuals, jackknife over captures or stretches of time.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "server/calib/camera/intrinsics.h"
#include "server/calib/core/wording.h"
#include "server/calib/motion/motion_observability.h"
#include "server/model/edges/edge.h"
#include "server/model/edges/method.h"
#include "server/model/sensors/camera_fit.h"
#include "server/model/sensors/pose_table.h"

namespace rigcal::calib {

// One sensor: a camera with its views of one board that stands still, or a tracker or pose stream with its poses.
struct HandEyeSide {
  Sensor sensor;
  std::optional<Target> board;                         // of a camera
  std::vector<std::pair<CaptureId, BoardView>> views;  // of a camera, sorted by id; a view may be not found
  PoseTable poses;                                     // of the others
};

struct HandEyeProblem {
  Method method = Method::kPoseStreams;  // or kNonOverlapping, kTrackerCamera, kEyeToHand
  HandEyeSide a, b;
  std::optional<Se3> T_a_b_nominal;  // one more start, and the value of what the motion leaves open
  CameraSolver solve_camera = {};
  std::vector<CaptureId> session_captures = {};  // all of the session: what is left out at once (CaptureBlocks)
};

// How noisy a side's poses are, as their residuals say; one sigma per axis, mean over the captures.
struct SideNoise {
  double translation_m = 0.0, rotation_rad = 0.0;
  double factor = 1.0;  // of a camera: on the variance that its corners let expect
};

// How much larger than given the squares of a camera's board are by the metres of a tracker.
struct BoardScale {
  double ratio = 0.0, sigma_ratio = 0.0;
  // By more than a hundredth and four sigmas, those of the size as given included.
  [[nodiscard]] bool Contradicts(const Target& board) const;
};

struct HandEyeEstimate {
  Se3 T_a_b, T_world_a_world_b;
  MotionReach reach;
  SideNoise noise_a, noise_b;
  std::map<CaptureId, Vector6d> residuals;         // Log((Z B)^-1 A X) of the captures used
  std::map<CaptureId, std::string> unused;         // why, in words
  double rms_m = 0.0, rms_rad = 0.0;               // of the residuals
  std::optional<double> offset_s, offset_sigma_s;  // of pose streams: t_a = t_b + offset
  std::optional<BoardScale> board_scale;           // of a camera and a tracker, where their motion tells it
  std::size_t captures = 0;                        // used; of streams: samples
};

struct HandEyeResult {
  HandEyeEstimate estimate;
  Uncertainty uncertainty;
  std::vector<Diagnosis> notes;
  std::optional<CameraEstimate> camera_a, camera_b;  // of sides that are cameras, from their pictures alone
};

// Pure; deterministic. A diagnosis says why there is no answer.
[[nodiscard]] OrDiagnosis<HandEyeResult> EstimateHandEye(const HandEyeProblem& problem);
// The finished edge; a failed one carries the diagnoses. Throws where there is no memory, else
// never. `fits`, if not null, becomes what it says of the cameras (camera_fit.h).
[[nodiscard]] Edge EstimateHandEyeEdge(const HandEyeProblem& problem, std::vector<CameraFit>* fits = nullptr);

}  // namespace rigcal::calib
