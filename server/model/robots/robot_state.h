// What whoever listens to a robot is told of it: its newest verdict, and the poses that it is to use.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "server/model/graph/graph.h"

namespace rigcal {

struct RobotState {
  Revision newest;         // without its document
  std::int64_t edges = 0;  // that counted when it was made, good and failed
  struct Calibration {
    Revision revision;  // without its document
    SensorId reference;
    std::vector<SensorPose> poses;
    std::optional<Eigen::Matrix3d> R_ref_robot = {};  // GraphSolution's
  };
  std::optional<Calibration> calibration;  // of the revision that is in use; absent: none is
  // Sensors that it has none of, of which poses may have been told before, in this run of the server or an earlier one.
  // Sorted.
  std::vector<SensorId> withdrawn = {};
};

}  // namespace rigcal
