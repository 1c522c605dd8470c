// Poses that are known but for some directions: which those are, in words, and how well the rest is known.
#pragma once

#include <optional>
#include <string>

#include "server/fleet/assess.h"

namespace rigcal::fleet {

// Columns: ahead, left and up of the robot in the reference's frame: x, y and z of a body that a pose stream or a
// tracker tells of (docs/session-format.md says so). The body is the reference or, of those that sessions draw, that of
// a pose stream rather than of a tracker, of the newest. Without one nothing: a header does not tell how a camera or a
// lidar is mounted.
[[nodiscard]] std::optional<Eigen::Matrix3d> RobotAxes(const SensorId& reference, const SessionHeaders& headers);

struct PartialPose {
  SensorId sensor;
  // "the height", "the forward position and the yaw", of the robot; where its axes are not known "the position along
  // z", of the reference; "one direction", "2 directions" where it is along no axis.
  std::string open;
  std::string frame;     // whose axes `open` names, "the frame of left"; empty: the robot's, or it names none
  bool several = false;  // that it names
  // Of what was measured, 1 sigma, the worst axis; nothing where no shift (turn) was.
  std::optional<double> sigma_m, sigma_rad;
};
// `pose` is not known and has open directions.
[[nodiscard]] PartialPose PartialPoseOf(const SensorPose& pose, const GraphSolution& solution,
                                        const SessionHeaders& headers);

}  // namespace rigcal::fleet
