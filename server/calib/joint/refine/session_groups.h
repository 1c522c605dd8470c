// What is told of a session beside its poses: which captures count as one and what they do, how noisy its sensors are.
#pragma once

#include <map>
#include <vector>

#include "server/calib/joint/refine/cluster_covariance.h"
#include "server/model/sessions/session_estimate.h"

namespace rigcal::calib::joint {

// By index of CaptureGroups, the captures in their order. `sensors`: of which the poses are told, with their index in
// the problem. A group moves poses by its column of PoseCovariance::influence, an empirical influence (Efron 1982).
[[nodiscard]] std::vector<CaptureGroup> GroupsTold(const SessionProblem& problem, const Refined& refined,
                                                   const PoseCovariance& covariance,
                                                   const std::map<SensorId, int>& sensors);
// By sensor.
[[nodiscard]] std::vector<ResidualNoise> NoiseTold(const SessionProblem& problem, const Refined& refined,
                                                   const std::map<SensorId, int>& sensors);

}  // namespace rigcal::calib::joint
