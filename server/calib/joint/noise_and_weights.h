// What the residuals of a refinement say of each sensor's noise (variance components, Helmert's simplified form), of looks
// that contradict the others, and of errors that the pictures of one burst share.
#pragma once

#include "server/calib/joint/normal_equations.h"

namespace rigcal::calib::joint {

// Per sensor, from what `fit` left at `before` and `weights`; a sensor with too few residuals keeps what it had.
[[nodiscard]] std::vector<SensorNoise> NoiseFrom(const SessionProblem& problem, const CaptureGroups& groups,
                                                 const LookWeights& weights, const SessionFit& fit,
                                                 const SessionState& state, const std::vector<SensorNoise>& before);

// Below 1 for a look whose squares are far beyond what is usual for its sensor; 1 / (1 + (n - 1) share) for the corners of
// a burst of n looks: as many say no more than that of one that shares nothing (Kish's design effect).
[[nodiscard]] LookWeights WeightsFrom(const SessionProblem& problem, const CaptureGroups& groups, const SessionFit& fit,
                                      const std::vector<SensorNoise>& noise);

}  // namespace rigcal::calib::joint
