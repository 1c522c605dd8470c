// Clocks of trackers: where a body moves while captures are taken, what is told for a capture's instant depends on the
// clock of who tells it.
#pragma once

#include "server/calib/joint/misfit/explained.h"

namespace rigcal::calib::joint {

// Of a clock of which the session says nothing, that it is right: networks and filters delay poses by tens of
// milliseconds.
constexpr double kClockSigma_s = 0.05;

// To the poses that `tracker` told in the problem: how its body moved about them, by `path`, where it surely did (else
// they stay as they are); and its clock to the problem. Nothing without a path, or where the session knows the clock
// exactly.
void AddClock(const Sensor& tracker, const PoseTable& path, SessionProblem& problem, SessionState& state);

// Where a clock is off by so much that paths were fitted about other instants, they are fitted again and all is refined
// again, at most three times; where that does not settle, `ClocksTold` says that the clock is not known.
[[nodiscard]] Explained WithClocksSettled(Explained now);

// `spread_ratio`: by how much variances are larger than the model's (PoseCovariance). `beside`: covariance of all
// unknowns by what their model does not describe (CovarianceByFields), empty where there is none.
[[nodiscard]] std::vector<TrackerClock> ClocksTold(const SessionProblem& problem, const Refined& refined,
                                                   double spread_ratio, const Eigen::MatrixXd& beside);

// Covariance of the unknowns by clocks that are told as not known though they were unknowns: along with what each is
// moved by, j = C_.d / C_dd, j j^T (sigma_told^2 - C_dd). Empty: none.
[[nodiscard]] Eigen::MatrixXd CovarianceByClocks(const Refined& refined, const std::vector<TrackerClock>& told);

}  // namespace rigcal::calib::joint
