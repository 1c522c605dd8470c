// How well the poses of a rig can be known from what an experiment records: the Cramer-Rao bound, from the truth.
#pragma once

#include <map>
#include <optional>

#include "client/sim/truth.h"

namespace rigcal::sim {

// Fisher information of all sensor poses in the reference, given the noise of corners, ranges and tracker, with what
// else is unknown eliminated (Schur complement): the robot's pose at each capture, the boards' poses and, unless they
// are exact, the lenses (with a calibration's sigmas as what is known beforehand). Enters what the pairs of the session
// use: corners of each camera's board where it is seen whole; points of each lidar on the boards of the cameras that it
// is calibrated with; tracker poses. The room's walls do not enter: they would tell two lidars more. Without noise
// there is no bound: empty. What happens at single captures (a sensor or board that is moved, a picture of
// another instant or shifted) is taken as if it had not; corners of a burst as if each had errors of its own.
[[nodiscard]] std::map<SensorId, BoundSigma> CramerRaoBound(const Experiment& experiment);

// The whole covariance of one sensor's pose; nothing where the data leave a direction of it open, or without noise.
[[nodiscard]] std::optional<Matrix6d> CramerRaoCovariance(const Experiment& experiment, const SensorId& sensor);

// Of what the bumped sensor's pose changed by, Log(T_before^-1 T_after), from the captures on both sides of the bump,
// the time of which is taken as known; nothing where one side leaves a direction open, without a bump or noise.
[[nodiscard]] std::optional<Matrix6d> CramerRaoCovarianceOfBump(const Experiment& experiment);

}  // namespace rigcal::sim
