// The work on one camera pair: where it begins, the problem as it shrinks and its state as it improves.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "server/calib/core/joint_problem.h"
#include "server/calib/core/wording.h"
#include "server/calib/stereo/stereo.h"

namespace rigcal::calib {

// Captures, views, turns and board poses side by side.
struct StereoWork {
  std::vector<std::size_t> used;              // indices into StereoProblem::captures
  std::map<std::size_t, std::string> unused;  // the others: why
  std::vector<int> turns_b;                   // already in `joint`: see StereoEstimate::turn_b
  JointProblem joint;
  JointState state;
  int iterations = 0;

  // `position`: in `used`. The capture becomes an unused one, for this reason.
  void Drop(std::size_t position, const std::string& why);
  // Of a corner's u or v at `state`: per degree of freedom.
  [[nodiscard]] double Variance_px2() const;
};

// From the views alone. `work` has captures and intrinsics, no T_a_b and no boards yet.
struct StereoStart {
  StereoWork work;
  // The T_a_b that most captures agree on; then, for a board that looks alike when turned, those that about as many
  // agree on with their views turned otherwise.
  std::vector<Se3> T_a_b;
  double width_px = 0;    // of the larger picture
  double distance_m = 0;  // of the boards, median
};
// "too_few_captures", "no_common_view", or why a camera's own intrinsics could not be started.
[[nodiscard]] OrDiagnosis<StereoStart> ColdStart(const StereoProblem& problem);
// From an earlier estimate: its captures, turns and board poses.
[[nodiscard]] StereoWork WarmStart(const StereoProblem& problem, const StereoEstimate& start);

// Sets the board poses, and the turns of a board that looks alike when turned, under the state's T_a_b and intrinsics.
// Drops the captures that no pose explains and gives their names.
[[nodiscard]] std::vector<CaptureId> PlaceBoards(const StereoProblem& problem, double width_px, StereoWork& work);
[[nodiscard]] OrDiagnosis<void> Refine(const StereoProblem& problem, StereoWork& work);
// Solves, lets the joint problem decide between the two poses of every board, and solves again until nothing changes.
[[nodiscard]] OrDiagnosis<void> RefineWithChoices(const StereoProblem& problem, StereoWork& work,
                                                  std::vector<Diagnosis>& notes);

// As Estimate() of stereo.h. What was left out on the way (contradicting or ambiguous captures) has its reason in
// `estimate.residuals`, and its diagnosis in `notes` if that is not null.
[[nodiscard]] OrDiagnosis<StereoEstimate> EstimateOrDiagnose(const StereoProblem& problem, const StereoEstimate* start,
                                                             std::vector<Diagnosis>* notes);

}  // namespace rigcal::calib
