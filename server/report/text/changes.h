// What is different between two solved states of a robot.
#pragma once

#include <cstddef>
#include <vector>

#include "server/formats/documents.h"

namespace rigcal::report {

// d = Log(T_old^-1 T_new), right tangent at the sensor; sigma of each axis: the larger of both revisions'.
struct SensorMove {
  SensorId sensor;
  Vector6d d = Vector6d::Zero(), sigma = Vector6d::Zero();
  double distance_m = 0.0, angle_rad = 0.0;
  double in_sigmas = 0.0;  // the largest |d| / sigma of the six axes; 0 where no sigma is known
};
// Both poses are known, in one reference.
[[nodiscard]] SensorMove MoveOf(const SensorPose& before, const SensorPose& now);

struct Changes {
  bool same_reference = true;     // false: poses are not compared
  std::vector<SensorMove> moves;  // sensors known in both, but for the reference; the largest in_sigmas first
  std::vector<SensorId> sensors_gained, sensors_lost;  // known now but not before, and the reverse; sorted
  std::vector<SensorId> sensors_retired;               // since; they are not among the lost ones
  std::vector<const Edge*> edges_gained, edges_lost;   // by id; into the revisions handed over
  std::vector<const Edge*> edges_past;                 // good before and past now; of the newer revision
};
// `before` and `now` outlive the answer.
[[nodiscard]] Changes Compare(const formats::RevisionInput& before, const formats::RevisionInput& now);

}  // namespace rigcal::report
