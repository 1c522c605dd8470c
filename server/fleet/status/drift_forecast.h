// When a sensor's place will have changed by its tolerance: learnt from what the visits of all robots of a rig model
// found of the calibration that was in use, as left to as found.
//
// Two laws. Random walk: a change over t is normal with variance s^2 t per axis. Linear: each robot's sensor goes on at
// a rate of its own, and the rates of the robots of a model are normal about zero with sigma s. To the variance of
// either comes that of the as-found test. How well s is known, and which law holds, is part of the answer: s is
// integrated over (flat in s), and the odds by either law count by how likely it is, flat in how far a sensor goes in a
// mean step, so that neither is likelier for the unit of time. Under the linear law the robot's own visits tell its
// rate, as far as they do; the rest is what the model's robots have in common.
#pragma once

#include <optional>
#include <vector>

#include "server/model/approval/policy.h"
#include "server/model/robots/robot_status.h"

namespace rigcal::fleet {

// What one visit found of one sensor.
struct DriftStep {
  RobotId robot;
  double days = 0.0;                   // from when the calibration in use was measured to the visit; more than 0
  Vector6d change = Vector6d::Zero();  // T_found = T_left Exp(change), m and rad
  Vector6d sigma = Vector6d::Zero();   // of that, by the as-found test; 0 of an axis that was not measured
};

// With fewer visits there is no forecast.
inline constexpr int kForecastVisitsMin = 3;
inline constexpr double kForecastOdds = 0.05;  // that the tolerance is exceeded at the date

struct DriftForecast {
  DriftLaw law = DriftLaw::kRandomWalk;
  double days = 0.0;  // after the calibration was measured
  int visits = 0, robots = 0;
};
// Of a sensor of `robot`: the time at which its odds to be further than `tolerance` (either half) from where it was
// left are kForecastOdds. Nothing where that is later than `days_max`, or too few of the steps are usable. The order of
// `steps` does not matter but for rounding.
[[nodiscard]] std::optional<DriftForecast> ForecastDrift(const std::vector<DriftStep>& steps, const RobotId& robot,
                                                         const PoseLimit& tolerance, double days_max);

// P(|x| > radius) of x in three dimensions, normal about a point `distance` from zero with sigma in each direction.
[[nodiscard]] double BeyondBall(double distance, double sigma, double radius);

}  // namespace rigcal::fleet
