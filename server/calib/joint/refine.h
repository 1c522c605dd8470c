// The optimum of a session's problem: Levenberg-Marquardt over everything at once, each sensor's noise and the weights of whole
// looks from their own residuals.
#pragma once

#include "server/base/result.h"
#include "server/calib/joint/noise_and_weights.h"

namespace rigcal::calib::joint {

struct Refined {
  SessionState state;
  std::vector<SensorNoise> noise;  // per sensor
  LookWeights weights;
  CaptureGroups groups;
  Layout layout;
  Linearized at_optimum;
  Eigen::MatrixXd covariance;      // H^-1 of the unknowns of the layout
};

// `start` must be feasible: every camera sees the corners that it saw.
// Fails with a sentence where the start is not feasible, the observations leave an unknown open, or no minimum is reached.
[[nodiscard]] Result<Refined> Refine(const SessionProblem& problem, const SessionState& start,
                                     const std::vector<SensorNoise>& noise, const CaptureGroups& groups);

// The sensor, other than the reference, whose pose the observations leave open most (too few of them, or all alike); kNone
// where they tell every unknown, or what they leave open is no sensor's.
[[nodiscard]] int OpenSensor(const SessionProblem& problem, const SessionState& state,
                             const std::vector<SensorNoise>& noise, const CaptureGroups& groups);

}  // namespace rigcal::calib::joint
