// How the sensors of one rig model sit on its robots, all together: spread against the drawing, and robots that stand
// out.
//
// Offsets: Log(T_center^-1 T_ref_sensor), right tangent at the sensor [x y z rx ry rz], m and rad; T_center is the
// nominal pose, or where there is none the robots' median pose (coordinate medians about it are zero). Spread: medians,
// quartiles, and 1.4826 times the median distance from the median. Outliers: server/fleet/population/outliers.h.
#pragma once

#include <map>
#include <vector>

#include "server/model/robots/population.h"
#include "server/model/robots/rig_model.h"

namespace rigcal::fleet {

struct SensorPlace {
  Se3 T_ref_sensor;                        // in the population's reference
  Matrix6d covariance = Matrix6d::Zero();  // right tangent at the sensor
};
struct RobotPlaces {
  RobotId robot;
  std::map<SensorId, SensorPlace> places;  // without the reference
};

// The odds that any robot of a population in which all are alike is accused, all its robots and sensors together,
// whatever the six axes of a sensor have in common.
inline constexpr double kPopulationAlpha = 1e-3;

// `robots` in any order, each once; `reference`: in which all of them are told. Of `model` only its name is needed.
// Same robots, same numbers. Fewer than kPopulationMin robots: `why_not`.
[[nodiscard]] Population DescribePopulation(const RigModel& model, const SensorId& reference,
                                            std::vector<RobotPlaces> robots);

}  // namespace rigcal::fleet
