// How the sensors of one rig model sit on its robots, all together, against the drawing.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "server/base/ids.h"
#include "server/math/se3.h"
#include "server/model/approval/policy.h"

namespace rigcal {

inline constexpr std::size_t kPopulationMin = 5;  // robots: fewer tell nothing of a spread

// Of one axis of one sensor over the robots, m or rad.
struct AxisSpread {
  double min = 0.0, lower = 0.0, median = 0.0, upper = 0.0, max = 0.0;  // lower, upper: quartiles
  double spread = 0.0;  // 1 sigma, robust: 1.4826 times the median distance from the median
};

// A robot on which a sensor sits elsewhere than on the others, beyond chance.
struct PopulationOutlier {
  RobotId robot;
  Vector6d offset = Vector6d::Zero();  // as SensorPopulation's
  std::size_t worst_axis = 0;          // x y z rx ry rz: along which it is off most, in spreads
  double odds = 1.0;                   // of so large a distance by chance, on this robot and sensor
};

struct SensorPopulation {
  SensorId sensor;
  std::optional<Se3> T_ref_nominal;  // as drawn, in the reference that is told; nothing: it is not drawn
  PoseLimit tolerance;               // of the drawing; 0 where it is not drawn
  // From where offsets are told: the nominal pose, or the robots' median pose. An offset is Log(T_center^-1
  // T_ref_sensor), right tangent at the sensor [x y z rx ry rz], m and rad.
  Se3 T_ref_center;
  std::array<AxisSpread, 6> axes = {};
  std::vector<RobotId> robots;              // that have a pose of it, sorted
  std::vector<Vector6d> offsets;            // of these
  std::vector<PopulationOutlier> outliers;  // the least likely first
  bool by_distance = false;  // by Mahalanobis' distance; else axis by axis, as the robots are too few for it
};

struct Population {
  std::string rig_model;
  std::int64_t version = 0;                               // of the rig model as it was set; 0: nobody has set it
  SensorId reference;                                     // in whose frame all is told
  std::vector<RobotId> robots;                            // that are counted, sorted
  std::vector<std::pair<RobotId, std::string>> left_out;  // and why: "no calibration in use"
  std::vector<SensorPopulation> sensors;  // of which at least kPopulationMin robots have a pose, by name
  std::vector<std::pair<SensorId, std::size_t>> too_few;  // other sensors, on how many robots
  std::string why_not;                                    // a sentence; empty: there are robots enough
};

// Which sensors sit on most robots beyond the tolerance of the drawing: "front_right sits 12 mm and 0.3 deg from its
// nominal (CAD) pose on most robots"; a sentence each.
[[nodiscard]] std::vector<std::string> OffTheDrawing(const Population& population);
// "mapper-07: left sits 31 mm and 0.2 deg from where the others have it"; a sentence each, the least likely of a sensor
// first.
[[nodiscard]] std::vector<std::string> OutlierTexts(const Population& population);
// The median offset of all robots.
[[nodiscard]] Vector6d MedianOf(const SensorPopulation& sensor);

}  // namespace rigcal
