// The optimum of a session's problem: Levenberg-Marquardt over everything at once, each sensor's noise and the weights
// of whole looks from their own residuals.
#pragma once

#include "server/base/result.h"
#include "server/calib/joint/refine/normal_equations.h"

namespace rigcal::calib::joint {

struct Refined {
  SessionState state;
  std::vector<SensorNoise> noise;  // per sensor
  LookWeights weights;
  CaptureGroups groups;
  Layout layout;
  Linearized at_optimum;
  Eigen::MatrixXd covariance;  // H^-1 of the unknowns of the layout
};

// `start` must be feasible: every camera sees the corners that it saw.
// Fails with a sentence where the start is not feasible, the observations leave an unknown open, or no minimum is
// reached.
[[nodiscard]] Result<Refined> Refine(const SessionProblem& problem, const SessionState& start,
                                     const std::vector<SensorNoise>& noise, const CaptureGroups& groups);

// The minimum with noise and weights held, or what some iterations make of it: while noise is taken for smaller than it
// is, Huber's loss is followed slowly, and a better noise is the better step. Moves `state` there. Fails with a
// sentence where the start is not feasible.
struct Minimum {
  Linearized at;
  bool settled = false;
  int iterations = 0;
};
[[nodiscard]] Result<Minimum> Minimize(const Linearization& of, SessionState& state);

// From where a session stands, one step of a problem that has the same looks and more unknowns, at the same noise and
// weights: enough to see that there is nothing of them. Nothing where the step is not to be had.
struct OneStep {
  Layout layout;
  Eigen::VectorXd step;
  Eigen::MatrixXd covariance;
};
[[nodiscard]] std::optional<OneStep> StepFrom(const SessionProblem& problem, const Refined& refined);

// Where cameras err from capture to capture by more than their corners scatter (loose mounts, pictures that were not
// taken at one instant), the place of each capture can follow one of them, whose noise then falls while that of all
// others grows, without end. Looks of cameras may err as a whole instead (LookError) where `noise` says so: whether it
// does, and noise that does.
[[nodiscard]] bool LooksErr(const SessionProblem& problem, const std::vector<SensorNoise>& noise);
[[nodiscard]] std::vector<SensorNoise> WithLooksThatErr(const SessionProblem& problem, std::vector<SensorNoise> noise);
// By how much looks of cameras err as a whole where they may not: b^T A^-1 b over their own six numbers, mean per
// number, of the camera of which it is most. Corners that err by themselves make less than 1 of it.
[[nodiscard]] double LooksBesideEachOther(const SessionProblem& problem, const Refined& refined);

// The sensor, other than the reference, whose pose the observations leave open most (too few of them, or all alike);
// kNone where they tell every unknown, or what they leave open is no sensor's.
[[nodiscard]] int OpenSensor(const SessionProblem& problem, const SessionState& state,
                             const std::vector<SensorNoise>& noise, const CaptureGroups& groups);

// What the residuals of a refinement say of each sensor's noise (variance components, Helmert's simplified form), of
// looks that contradict the others, and of errors that the pictures of one burst share.
//
// Per sensor, from what `fit` left at `before` and `weights`; a sensor with too few residuals keeps what it had.
[[nodiscard]] std::vector<SensorNoise> NoiseFrom(const SessionProblem& problem, const CaptureGroups& groups,
                                                 const LookWeights& weights, const SessionFit& fit,
                                                 const SessionState& state, const std::vector<SensorNoise>& before);

// Below 1 for a look whose squares are far beyond what is usual for its sensor; 1 / (1 + (n - 1) share) for the corners
// of a burst of n looks: as many say no more than that of one that shares nothing (Kish's design effect).
[[nodiscard]] LookWeights WeightsFrom(const SessionProblem& problem, const CaptureGroups& groups, const SessionFit& fit,
                                      const std::vector<SensorNoise>& noise);

}  // namespace rigcal::calib::joint
