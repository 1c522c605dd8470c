// How far a sensor would sit from where another calibration has it.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "server/base/ids.h"

namespace rigcal {

struct PoseChange {
  SensorId sensor;
  std::string how;  // "moved"; "gained", "lost": only one of the two knows its pose, and there are no numbers
  double moved_m = 0.0, turned_rad = 0.0;
  std::optional<double> sigma_ratio = {};  // in sigmas of the calibration of before, the worst axis; absent: not known
};

}  // namespace rigcal
