// The optimum of a session's problem: Levenberg-Marquardt over everything at once, each sensor's noise from its own residuals
// (variance components, Helmert's simplified form), whole looks that contradict the others held back.
#pragma once

#include "server/base/result.h"
#include "server/calib/joint/normal_equations.h"

namespace rigcal::calib::joint {

struct Refined {
  SessionState state;
  std::vector<SensorNoise> noise;  // per sensor
  LookWeights weights;             // below 1: the look contradicts the others
  std::vector<int> group_of_place;
  int groups = 0;
  Layout layout;
  Linearized at_optimum;
  Eigen::MatrixXd covariance;      // H^-1 of the unknowns of the layout
};

// `start` must be feasible: every camera sees the corners that it saw. `group_of_place` ascending from 0 (GroupsOf).
// Fails with a sentence where the start is not feasible, the observations leave an unknown open, or no minimum is reached.
[[nodiscard]] Result<Refined> Refine(const SessionProblem& problem, const SessionState& start,
                                     const std::vector<SensorNoise>& noise, const std::vector<int>& group_of_place);

// The sensor, other than the reference, whose pose the observations leave open most (too few of them, or all alike); kNone
// where they tell every unknown, or what they leave open is no sensor's.
[[nodiscard]] int OpenSensor(const SessionProblem& problem, const SessionState& state,
                             const std::vector<SensorNoise>& noise, const std::vector<int>& group_of_place);

// Captures contiguous in time, those of one place (a burst) in one group, at most `groups_max` groups of nearly equal size.
[[nodiscard]] std::vector<int> GroupsOf(const SessionProblem& problem, const SessionState& state, int groups_max = 40);

}  // namespace rigcal::calib::joint
