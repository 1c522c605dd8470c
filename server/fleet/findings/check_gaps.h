// What of a measurement the rest of its graph would not show to be wrong: along which axes, and how roughly.
#pragma once

#include <string>
#include <vector>

#include "server/fleet/assess.h"

namespace rigcal::fleet {

// Of an edge's position or rotation: the edge says it to its tolerance, the others do not.
struct CheckGap {
  const Edge* edge = nullptr;
  bool is_position = true;
  std::string what;              // "the position", "the height", "the position along z of left"
  bool names_sensor = false;     // the sensor of whose frame `what` has an axis
  bool several = false;          // `what` is more than one axis
  double times_tolerance = 0.0;  // that the others know it to, 1 sigma; infinite: they say nothing of it
  [[nodiscard]] bool by_nothing() const;
};

// `by_others`: information at b, 1/m^2 and 1/rad^2 (OtherPaths). Axes as poses that are known in part have them: the
// robot's, without these the reference's. Those that the policy needs of neither sensor (not_needed.h) are left out;
// the reference's own pose is never in need.
[[nodiscard]] std::vector<CheckGap> GapsOf(const Edge& edge, const Matrix6d& by_others, const GraphSolution& solution,
                                           const Policy& policy);

}  // namespace rigcal::fleet
