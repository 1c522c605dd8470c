// A 3D lidar and a tracker that ride on one body, from boards that stand still in the tracker's world: the lidar sees
// them as planes, the tracker tells where the body was. Which patches are boards is settled by agreement over the
// captures; T_body_lidar, the boards' planes and the body's poses are refined at once; jackknife over captures.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "server/calib/core/wording.h"
#include "server/calib/motion/motion_observability.h"
#include "server/calib/planes/plane_moments.h"
#include "server/calib/planes/static_planes.h"
#include "server/model/edges/edge.h"
#include "server/model/sensors/features.h"
#include "server/model/sessions/session.h"

namespace rigcal::calib {

// One capture: where the body was and what may be a board in the cloud.
struct TrackerLidarCapture {
  CaptureId capture;
  std::optional<Se3> T_world_body;
  std::vector<CloudView> clouds;  // the same cloud searched for each of the problem's boards, or none
};

struct TrackerLidarProblem {
  Sensor tracker, lidar;
  std::vector<Target> boards;  // those the lidar may see, of different plates
  std::vector<TrackerLidarCapture> captures;
  bool tracker_is_a = false;                     // the edge's frame_a is the tracker's
  double range_bias_m = 0.0;                     // known: ranges are too short by this much
  std::optional<Se3> T_body_lidar_nominal;       // the first start, and the value of what the motion leaves open
  std::vector<CaptureId> session_captures = {};  // all of the session: what is left out at once (CaptureBlocks)
};

struct TrackerLidarCheck {
  double distance_m =
      0.0;  // rms over the capture's boards: of the points' mean distance, the body where the tracker says
  double angle_rad = 0.0;  // likewise between the normals
  std::size_t points = 0, boards = 0;
};

struct TrackerLidarEstimate {
  Se3 T_body_lidar;
  std::vector<WorldPlane> boards;  // in the tracker's world
  PlaneReach reach;
  MotionReach motion;                             // of the body alone: for words
  std::map<CaptureId, TrackerLidarCheck> checks;  // of captures used
  std::map<CaptureId, std::string> unused;        // why, in words
  Matrix6d information = Matrix6d::Zero();        // of the model, right tangent at the lidar; zero along what is open
  double noise_m = 0.0, noise_rad = 0.0;          // of one pose of the tracker, per axis, as the residuals say
  double range_sigma_m = 0.0;                     // of one point, from the scatter within patches
  double rms_m = 0.0, rms_rad = 0.0;              // of the captures' checks
};

struct TrackerLidarResult {
  TrackerLidarEstimate estimate;
  Uncertainty uncertainty;  // of the edge's T_a_b
  std::vector<Diagnosis> notes;
};

// Pure; deterministic. A diagnosis says why there is no answer.
[[nodiscard]] OrDiagnosis<TrackerLidarResult> EstimateTrackerLidar(const TrackerLidarProblem& problem);
// The finished edge (method "tracker_lidar"); a failed one carries the diagnoses. Throws where there is no memory,
// else never.
[[nodiscard]] Edge EstimateTrackerLidarEdge(const TrackerLidarProblem& problem);

}  // namespace rigcal::calib
