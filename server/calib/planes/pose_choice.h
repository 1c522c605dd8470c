// Which of the poses that a planar board allows is the right one: both cameras together decide.
#pragma once

#include <limits>
#include <vector>

#include "server/calib/core/joint_problem.h"

namespace rigcal::calib {

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
