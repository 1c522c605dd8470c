// Poses that a tracker, a robot or an odometry reports: the rows of a poses.csv.
#pragma once

#include <vector>

#include "server/base/ids.h"
#include "server/base/stamp.h"
#include "server/math/se3.h"

namespace rigcal {

struct TimedPose {
  CaptureId capture;  // of a tracker; empty in a pose stream and in a tracker's path
  Stamp stamp;        // of the clock that made the table
  Se3 T_world_body;
};
// A tracker's rows by capture, each once; a pose stream's, and those of a tracker's path, by stamp, strictly
// increasing.
using PoseTable = std::vector<TimedPose>;

}  // namespace rigcal
