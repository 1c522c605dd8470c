// Overlapping cameras: intrinsics, board poses and T_a_b from checkerboard views (Zhang 2000), own joint refinement,
// jackknife over captures with everything re-estimated.
#pragma once

#include <map>
#include <optional>
#include <vector>

#include "server/model/edges/edge.h"
#include "server/model/sensors/camera_fit.h"
#include "server/model/sensors/features.h"
#include "server/model/sessions/session.h"

namespace rigcal::calib {

// One capture as both cameras saw it. A view may be not found; captures are sorted by id.
struct StereoCapture {
  CaptureId capture;
  std::optional<BoardView> a, b;
};

struct StereoProblem {
  Sensor camera_a, camera_b;  // intrinsics given (with sigmas: refined within them) or absent
  Target board;
  std::vector<StereoCapture> captures;
  std::vector<CaptureId> session_captures = {};  // all of the session: what is left out at once (CaptureBlocks)
};

struct StereoEstimate {
  CameraIntrinsics intrinsics_a, intrinsics_b;
  Se3 T_a_b;                           // pose of camera b in camera a
  std::map<CaptureId, Se3> T_a_board;  // per capture used
  // Of b's view against a's, times 360 / SymmetryOf(board) degrees, for boards that look alike when turned: how b's
  // corners are renumbered. Captures not named: 0.
  std::map<CaptureId, int> turn_b;
  double rms_px = 0;  // sqrt(sum of squared distances / number of points), both views (OpenCV's)
  double rms_a_px = 0, rms_b_px = 0;
  Matrix6d C_model = Matrix6d::Zero();     // s^2 H^-1 of the joint problem, right tangent at b
  std::vector<CaptureResidual> residuals;  // per capture
  int iterations = 0;
  // Where intrinsics were given with sigmas, and so refined: what corners counted against them, and what one sigma of
  // each does to T_a_b (right tangent at b), ascending. C_model is then the corners' part alone.
  double corner_sigma_px = 0;
  std::vector<Vector6d> shifts_a, shifts_b;
};

// Is it solvable? Empty: yes. Otherwise why not: too few captures with both views, board not found in ..., all boards
// parallel to the image (no tilt) or only by a lens model that is not the camera's, ...
[[nodiscard]] std::vector<Diagnosis> Observability(const StereoProblem& problem);
// Pure; deterministic for any thread count. `start` warm-starts the refinement (jackknife).
[[nodiscard]] Result<StereoEstimate> Estimate(const StereoProblem& problem, const StereoEstimate* start = nullptr);
// Leave one capture out, warm start, in parallel; block vectors in capture order. Adds the contribution of the board's
// size (square_sigma_m) and of the sigmas that intrinsics were given with. Below 5 captures the source is the model:
// the model alone, blind to errors that a capture's corners share, understates sigma about twice on real pictures.
[[nodiscard]] Result<Uncertainty> Jackknife(const StereoProblem& problem, const StereoEstimate& estimate);

// The three above as the finished edge; a failed one carries the diagnoses. Fills figures (rms_px, captures_used, ...).
// `fits`, if not null, becomes what it says of both cameras (camera_fit.h).
[[nodiscard]] Edge EstimateEdge(const StereoProblem& problem, std::vector<CameraFit>* fits = nullptr);

}  // namespace rigcal::calib
