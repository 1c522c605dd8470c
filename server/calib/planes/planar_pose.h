// The poses of a flat target that one view allows, and which of them is the right one: both cameras together decide.
#pragma once

#include <limits>
#include <vector>

#include "server/calib/camera/projection.h"
#include "server/calib/camera/seen_corners.h"
#include "server/calib/core/joint_problem.h"
#include "server/math/se3.h"

namespace rigcal::calib {

// Poses T_cam_board that explain one view, best first: a plane seen small has two (Collins & Bartoli 2014). A start,
// not refined. Looks along the middle ray of the view, so the target may be anywhere a fisheye sees; corners farther
// than 80 degrees from that ray are left away. May be empty.
[[nodiscard]] std::vector<Se3> PlanarPoses(CameraModel model, const IntrinsicsVector& intrinsics,
                                           const std::vector<Eigen::Vector3d>& corners_board, const SeenCorners& seen);

// The pose that fits both cameras best, with its sum of squared residuals; `other` tells how nearly another one does.
struct PoseChoice {
  Se3 T_a_board;
  double ssr_px2 = std::numeric_limits<double>::infinity();
  // The best other minimum, more than a degree away; infinite if there is none.
  Se3 T_a_board_other;
  double other_ssr_px2 = std::numeric_limits<double>::infinity();
};

// The poses T_a_board of one capture that either camera's view allows under `state`.
[[nodiscard]] std::vector<Se3> AllowedPoses(const JointProblem& problem, const JointState& state,
                                            std::size_t capture_idx);
// Refines every candidate over all views of the capture, all else held. Infinite if none is feasible.
[[nodiscard]] PoseChoice ChoosePose(const JointProblem& problem, const JointState& state, std::size_t capture_idx,
                                    const std::vector<Se3>& candidates);

}  // namespace rigcal::calib
