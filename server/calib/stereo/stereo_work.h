// The work on one camera pair: the problem as it shrinks and its state as it improves.
#pragma once

#include <map>
#include <string>
#include <tl/expected.hpp>
#include <vector>

#include "server/calib/core/joint_problem.h"
#include "server/calib/stereo/stereo.h"

namespace rigcal::calib {

template <typename T>
using OrDiagnosis = tl::expected<T, Diagnosis>;

// Captures, views, turns and board poses side by side.
struct StereoWork {
  std::vector<std::size_t> used;              // indices into StereoProblem::captures
  std::map<std::size_t, std::string> unused;  // the others: why
  std::vector<int> turns_b;                   // already in `joint`: see StereoEstimate::turn_b
  JointProblem joint;
  JointState state;
  int iterations = 0;

  void Drop(std::size_t position, const std::string& why);
  [[nodiscard]] double SumOfSquares_px2() const;
  // Of a corner's u or v: per degree of freedom.
  [[nodiscard]] double Variance_px2() const;
};

// Sets the board poses, and the turns of a board that looks alike when turned, under the state's T_a_b and intrinsics.
// Drops the captures that no pose explains and gives their names.
[[nodiscard]] std::vector<CaptureId> PlaceBoards(const StereoProblem& problem, double width_px, StereoWork& work);
[[nodiscard]] OrDiagnosis<void> Refine(const StereoProblem& problem, StereoWork& work);
// Solves, lets the joint problem decide between the two poses of every board, and solves again until nothing changes.
[[nodiscard]] OrDiagnosis<void> RefineWithChoices(const StereoProblem& problem, StereoWork& work,
                                                  std::vector<Diagnosis>& notes);

}  // namespace rigcal::calib
