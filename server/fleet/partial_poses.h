// Poses that are known but for some directions: which those are, in words, and how well the rest is known.
#pragma once

#include <optional>
#include <string>

#include "server/fleet/assess.h"

namespace rigcal::fleet {

struct PartialPose {
  SensorId sensor;
  // "the height", "the forward position and the yaw", "one direction", "2 directions": of the robot where the
  // reference's axes are taken as x forward, y left, z up; of a camera as z forward, x right, y down.
  std::string open;
  bool several = false;  // that it names
  // Of what is told, 1 sigma, the worst axis; nothing where no one edge ties the sensor to a known one by all of it, or
  // where a rotation is open.
  std::optional<double> sigma_m, sigma_rad;
};
// `pose` is not known and has open directions.
[[nodiscard]] PartialPose PartialPoseOf(const SensorPose& pose, const std::vector<Edge>& edges,
                                        const GraphSolution& solution, const SessionHeaders& headers);

}  // namespace rigcal::fleet
