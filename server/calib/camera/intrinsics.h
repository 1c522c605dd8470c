// One camera and one board: intrinsics, if they are not given, and the board's pose in every view.
#pragma once

#include <functional>
#include <map>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "server/calib/camera/given_intrinsics.h"
#include "server/calib/camera/view_moments.h"
#include "server/calib/core/wording.h"
#include "server/model/diagnosis.h"
#include "server/model/sensors/features.h"
#include "server/model/sessions/session.h"

namespace rigcal::calib {

struct CameraProblem {
  Sensor camera;  // intrinsics given (with sigmas: refined within them), or estimated as camera_model
  Target board;
  std::vector<std::pair<CaptureId, BoardView>> views;  // sorted by id; a view may be not found
  friend bool operator==(const CameraProblem&, const CameraProblem&) = default;
};

struct CameraEstimate {
  CameraIntrinsics intrinsics;
  std::map<CaptureId, Se3> T_cam_board;  // of every view used
  // J^T J of T_cam_board (right tangent at the board) with the intrinsics held, for corners of unit sigma: px^-2.
  // Divided by variance_px2 it is the information of the pose.
  std::map<CaptureId, Matrix6d> information;
  // Views whose other pose fits almost as well (a plane seen small has two): those poses, refined.
  std::map<CaptureId, std::vector<Se3>> alternatives;
  std::map<CaptureId, double> rms_by_capture_px;  // as rms_px, of one view
  std::map<CaptureId, std::string> unused;        // why, in words
  double rms_px = 0;                              // sqrt(sum of squared distances / number of points)
  double variance_px2 = 0;  // of a corner's u or v: sum of squared residuals / (residuals - parameters)
  // Where the intrinsics were given with sigmas, and so refined: what pulled, and what each view used says of them.
  IntrinsicsPull pull;
  std::map<CaptureId, ViewOfIntrinsics> of_intrinsics;

  // All poses that the capture's view allows, the likeliest first; none of a view that was not used.
  [[nodiscard]] std::vector<Se3> PosesOf(const CaptureId& capture) const;
};

// EstimateCamera without a start, or something that remembers what it said (and then must outlive the problem it is put
// into); empty: EstimateCamera.
using CameraSolver = std::function<OrDiagnosis<CameraEstimate>(const CameraProblem&)>;

// Pure and deterministic. Given intrinsics without sigmas stay as given: poses only, one view is enough. With sigmas
// all views refine them within those, and one view is enough too. Estimated ones need 3 views with tilted boards. With
// `start`, from its intrinsics and poses: the captures it has, with their alternatives kept as they are, unrefined
// (leave-one-out). Throws where there is no memory, else never.
[[nodiscard]] OrDiagnosis<CameraEstimate> EstimateCamera(const CameraProblem& problem,
                                                         const CameraEstimate* start = nullptr);
[[nodiscard]] OrDiagnosis<CameraEstimate> EstimateCameraBy(const CameraSolver& solver, const CameraProblem& problem);

// intrinsics_variants.cc: a camera whose intrinsics were given with sigmas, with one thing changed. Intrinsics and
// board poses follow to first order, as changes are small against what the sigmas allow.
//
// `estimate.pull` pulls. The view's own pose is gone too.
[[nodiscard]] CameraEstimate WithoutViews(const CameraEstimate& estimate, const std::set<CaptureId>& captures);
// What the errors of the corners do to refined or estimated intrinsics: independent changes of one sigma each.
[[nodiscard]] std::vector<IntrinsicsVector> ChangesByCorners(const CameraEstimate& estimate);
[[nodiscard]] CameraEstimate WithIntrinsicsMoved(CameraEstimate estimate, const IntrinsicsVector& change);
// The intrinsic with that index given larger by so many of its sigmas.
[[nodiscard]] CameraEstimate WithGiven(const CameraEstimate& estimate, int idx, double sigmas);

}  // namespace rigcal::calib
