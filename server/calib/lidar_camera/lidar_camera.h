// A 3D lidar and a camera from a board that both see (Unnikrishnan & Hebert 2005): board poses from the pictures, the
// board's patch chosen in each cloud by agreement over the captures, joint point-to-plane refinement, jackknife over
// captures with everything re-estimated.
#pragma once

#include <map>
#include <optional>
#include <vector>

#include "server/calib/camera/intrinsics.h"
#include "server/calib/core/wording.h"
#include "server/calib/lidar_camera/plane_problem.h"
#include "server/math/se3.h"
#include "server/model/edges/edge.h"
#include "server/model/sensors/camera_fit.h"
#include "server/model/sensors/features.h"
#include "server/model/sessions/session.h"

namespace rigcal::calib {

// One capture: what the camera saw and every patch of the cloud that may be the board. Sorted by id.
struct LidarCameraCapture {
  CaptureId capture;
  std::optional<BoardView> view;
  std::optional<CloudView> cloud;
};

struct LidarCameraProblem {
  Sensor camera, lidar;
  Target board;
  std::vector<LidarCameraCapture> captures;
  bool camera_is_a = true;                 // the edge's frame_a is the camera's
  double range_bias_m = 0.0;               // known: ranges are too short by this much
  std::optional<Se3> T_cam_lidar_nominal;  // one more start, and the judge between two that fit equally
  CameraSolver solve_camera = {};
  std::vector<CaptureId> session_captures = {};  // all of the session: what is left out at once (CaptureBlocks)
};

struct LidarCameraCheck {
  double distance_m = 0.0;  // mean distance of the cloud's points from the board; positive: behind it
  double angle_rad = 0.0;   // between the normals
  std::size_t points = 0;
};

struct LidarCameraEstimate {
  Se3 T_cam_lidar;
  CameraEstimate camera;                         // from the pictures alone, with the pose that the cloud confirms
  std::map<CaptureId, std::size_t> patch_idx;    // of the candidate that is the board, per capture used
  std::map<CaptureId, LidarCameraCheck> checks;  // likewise
  Matrix6d C_model = Matrix6d::Zero();           // s^2 H^-1 with the intrinsics as known, right tangent at the lidar
  std::optional<HeldDirection> held;             // where all normals lie in one plane
  Vector6d untold = Vector6d::Zero();            // what then is not told, unit, right tangent at the lidar
  double range_sigma_m = 0.0;                    // of one point, from the scatter within patches
  double capture_sigma_m = 0.0;                  // what the points of one capture share, between captures
  // Ranges are too short by this: estimated beside, not applied.
  double range_bias_m = 0.0, range_bias_sigma_m = 0.0;
  // Boards are larger than given by this part: likewise.
  double board_scale_ratio = 0.0, board_scale_sigma_ratio = 0.0;
  bool scale_fits_better = false;             // than a range bias does
  std::map<CaptureId, PlaneMoments> moments;  // of the board's points, per capture used
  double rms_m = 0.0;                         // of the captures' mean distances
  double rms_rad = 0.0;                       // of their angles
  std::vector<CaptureResidual> residuals;     // per capture: mean distance, metres

  // Range bias and size of the board could both be told from the captures; else their figures are 0 and mean nothing.
  [[nodiscard]] bool KnowsSystematics() const { return range_bias_sigma_m > 0 && board_scale_sigma_ratio > 0; }
  [[nodiscard]] bool SuspectsBoardSize() const;
  [[nodiscard]] bool SuspectsRangeBias() const;  // it is large and beyond its own uncertainty
};

// The camera alone, with every picture, also one without the board: so it is the same problem as that of the camera's
// other pairs.
[[nodiscard]] CameraProblem CameraOf(const LidarCameraProblem& problem);
// Pure; deterministic. A diagnosis says why there is no answer. What was left out on the way has its reason in
// `residuals`, and its diagnosis in `notes` if that is not null. `start` keeps choices (patches, captures) and
// warm-starts the rest.
[[nodiscard]] OrDiagnosis<LidarCameraEstimate> EstimateLidarCamera(const LidarCameraProblem& problem,
                                                                   const LidarCameraEstimate* start,
                                                                   std::vector<Diagnosis>* notes);
// T_a_b of the edge and its uncertainty: leave one capture out; contributions of the board's size, given intrinsics and
// the range bias.
[[nodiscard]] Result<Uncertainty> JackknifeLidarCamera(const LidarCameraProblem& problem,
                                                       const LidarCameraEstimate& estimate);
// Both as the finished edge (method "lidar_camera"); a failed one carries the diagnoses.
// `fits`, if not null, becomes what it says of the camera (camera_fit.h).
[[nodiscard]] Edge EstimateLidarCameraEdge(const LidarCameraProblem& problem, std::vector<CameraFit>* fits = nullptr);

}  // namespace rigcal::calib
