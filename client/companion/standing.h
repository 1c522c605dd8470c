// Where a growing session stands: what every sensor has, how well the poses would be known, what to do next.
#pragma once

#include <string>
#include <vector>

#include "client/companion/rig_so_far.h"
#include "server/calib/placement/next_placement.h"

namespace rigcal::companion {

struct Standing {
  Captured captured;
  std::vector<CaptureId> captures;  // in order
  RigSoFar so_far;
  calib::placement::PlacementAdvice advice;  // of so_far.rig
  // All sensors are cameras, each tied to the reference, every pose and lens within its limit, and every pair of a loop
  // has the captures that `rigcal check` and the server want of it. False where a sensor is not judged here: no carried
  // board reaches it, or it is no camera.
  bool is_enough = false;
  std::string headline;              // one sentence: what to do now
  std::vector<std::string> remarks;  // what this does not look at, what is missing: sentences
};
// Pure and deterministic. Throws std::bad_alloc.
[[nodiscard]] Standing StandingOf(Captured captured);

// Where the camera of `so_far.rig` stands there; nothing of another sensor.
[[nodiscard]] std::optional<std::size_t> PlannedIndexOf(const RigSoFar& so_far, const SensorId& sensor);
// Captures that others have a file of and this sensor has none.
[[nodiscard]] std::vector<CaptureId> MissingOf(const Standing& standing, const SensorId& sensor);

// standing_text.cc: the headline, a line per sensor, remarks.
void PrintStanding(const Standing& standing, std::ostream& out);
// standing_json.cc: docs/companion.md, the document.
[[nodiscard]] std::string StandingJson(const Standing& standing);

}  // namespace rigcal::companion
