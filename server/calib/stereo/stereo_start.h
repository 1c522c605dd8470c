// Where the joint refinement of a camera pair begins.
#pragma once

#include "server/calib/stereo/stereo_work.h"

namespace rigcal::calib {

// From the views alone. `work` has captures and intrinsics, no T_a_b and no boards yet.
struct StereoStart {
  StereoWork work;
  // The T_a_b that most captures agree on; then, for a board that looks alike when turned, those that about as many
  // agree on with their views turned otherwise.
  std::vector<Se3> T_a_b;
  double width_px = 0;    // of the larger picture
  double distance_m = 0;  // of the boards, median
};
[[nodiscard]] OrDiagnosis<StereoStart> ColdStart(const StereoProblem& problem);
// From an earlier estimate: its captures, turns and board poses.
[[nodiscard]] StereoWork WarmStart(const StereoProblem& problem, const StereoEstimate& start);

}  // namespace rigcal::calib
