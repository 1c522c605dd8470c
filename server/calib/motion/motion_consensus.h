// Which of the poses that each view allows is the right one, and where X is roughly: what most captures agree on.
#pragma once

#include <optional>
#include <vector>

#include "server/calib/motion/motion_problem.h"

namespace rigcal::calib {

struct PoseCandidate {
  SidePose pose;
  double penalty = 0.0;  // how much worse it fits its own view, in squared sigmas
  bool as_found = true;  // false: the board taken as turned
};
// One capture: the poses that either side allows, none empty.
struct MotionCandidates {
  std::vector<PoseCandidate> a, b;
};

struct MotionChoice {
  std::size_t a = 0, b = 0;
  double squares = 0.0;  // of the residual, in squared sigmas, the penalties included
};
struct MotionConsensus {
  Se3 X, Z;
  std::vector<MotionChoice> choices;  // per capture
  double median = 0.0;                // of the choices' squares
};

// Samples of three captures, in a fixed order, each solved in closed form and judged by the median over all captures,
// then refined. `nominal`: one more start. Nothing where there are fewer than three captures.
[[nodiscard]] std::optional<MotionConsensus> FindConsensus(const std::vector<MotionCandidates>& captures,
                                                           const std::optional<Se3>& nominal);
// The best choice of every capture under X and Z.
[[nodiscard]] MotionConsensus ChooseUnder(const std::vector<MotionCandidates>& captures, const Se3& X, const Se3& Z);
[[nodiscard]] MotionProblem ProblemOf(const std::vector<MotionCandidates>& captures,
                                      const std::vector<MotionChoice>& choices);

}  // namespace rigcal::calib
