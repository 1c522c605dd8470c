// What contradicts the rest of a graph: named, never dropped.
#pragma once

#include <vector>

#include "server/base/ids.h"
#include "server/math/se3.h"

namespace rigcal {

// An edge that the others speak against.
struct SuspectEdge {
  EdgeId edge;
  SensorId frame_a, frame_b;
  Vector6d e = Vector6d::Zero();     // residual at the robust optimum, to which the edge contributes nothing
  double statistic = 0.0;            // e^T (C_edge + C_prediction)^-1 e
  double limit = 0.0;                // of its test
  std::vector<EdgeId> alternatives;  // edges that explain the contradiction as well if they are wrong instead; sorted
};

// The edges of a sensor fall into two groups, each of one mind. Neither is called wrong.
struct TwoPoses {
  SensorId sensor;
  std::vector<EdgeId> group_a, group_b;    // sorted; the larger first (ties: the one with the smallest id)
  Vector6d difference = Vector6d::Zero();  // Log(T_ref_sensor_a^-1 T_ref_sensor_b), right tangent at the sensor
};

struct Suspects {
  bool judged = false;              // false: nothing to compare, or too large a graph
  std::vector<SuspectEdge> edges;   // sorted by edge id; without those of `two_poses`
  std::vector<TwoPoses> two_poses;  // sorted by sensor
};

}  // namespace rigcal
