// Two 3D lidars from what both see of their surroundings, no target: NDT from the nominal pose, coarse to fine, from
// several starts; then a polish by generalised ICP, which is the answer if asked for. How far it moves the pose goes
// into the uncertainty in any case: errors of the method are the same in every capture, so no jackknife sees them.
// Every capture brings its own map; the pose is common.
#pragma once

#include <optional>
#include <vector>

#include "server/calib/core/wording.h"
#include "server/model/edges/edge.h"
#include "server/model/sessions/session.h"

namespace rigcal::calib {

// Sorted by id. Points in each lidar's own frame; an empty cloud was not there or could not be read (`why_not`).
struct LidarLidarCapture {
  CaptureId capture;
  std::vector<Eigen::Vector3f> a_m, b_m;
  std::string why_not;
};

struct LidarLidarProblem {
  Sensor lidar_a, lidar_b;
  std::optional<Se3> T_a_b_nominal;  // no search without it
  std::vector<LidarLidarCapture> captures;
  bool polish = false;                           // the answer is the polished pose, not NDT's
  std::vector<CaptureId> session_captures = {};  // all of the session: what is left out at once (CaptureBlocks)
};

// How well a pose fits clouds that it was not made from, by flat voxels of NDT's finest size.
//   D: mean n_1 . (R_12 n_2) over flat voxels of both clouds on one surface, normals towards their sensors; angle: mean
//   E_l: norm of the mean of p_t - (R p_s + t), and its rms; p_s: the mean of a cell of the moving cloud, p_t: its foot
//   on the nearest flat voxel's surface; only pairs within 0.15 voxels of each other, so that what one lidar alone sees
//   does not count
struct SurfaceCheck {
  double D = 0, angle_rad = 0, E_l_m = 0, rms_m = 0;
  std::size_t normals = 0, pairs = 0;  // behind D, behind E_l
};

struct LidarLidarEstimate {
  Se3 T_a_b;
  Se3 T_a_b_ndt, T_a_b_polished;  // T_a_b is one of them
  bool polished = false;
  double voxel_m = 1;       // of NDT's finest level
  double last_step = 0;     // m and rad, of the last stage
  Uncertainty uncertainty;  // of T_a_b
  SurfaceCheck check;       // held out: each capture by the pose without it; with one capture, each half of its points
  bool check_on_captures = false;
  double overlap_ratio = 0;                // part of the moving cloud that has a voxel of the map about it
  double match_ratio = 0;                  // part of the points beside a flat voxel that lie on it
  double agreeing_ratio = 0;               // part of the starts that ended at this pose
  double halves_m = 0, halves_rad = 0;     // difference of the answers from either half, one capture
  std::vector<CaptureResidual> residuals;  // per capture: rms of held-out distances, metres
};

// Pure; the same bits for any number of threads. A diagnosis says why there is no answer; `notes`, if not null, what a
// reader should know of a good one.
[[nodiscard]] OrDiagnosis<LidarLidarEstimate> EstimateLidarLidar(const LidarLidarProblem& problem,
                                                                 std::vector<Diagnosis>* notes);
// The same as the finished edge (method "lidar_lidar"); a failed one carries the diagnosis.
[[nodiscard]] Edge EstimateLidarLidarEdge(const LidarLidarProblem& problem);

}  // namespace rigcal::calib
