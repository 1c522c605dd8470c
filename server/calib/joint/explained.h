// What is behind a session besides one rig: sensors that were moved and lenses that bend, taken out one after the
// other.
#pragma once

#include "server/calib/joint/lens_misfit.h"
#include "server/calib/joint/moved_sensor.h"
#include "server/calib/joint/session_start.h"

namespace rigcal::calib::joint {

// A session as it is explained so far: a sensor that was moved is two sensors of one name, a lens that bends has its
// field held in the state.
struct Explained {
  SessionStart start;
  Refined refined;
  FoundMisfits misfits;
};

// Fails as Refine does.
[[nodiscard]] Result<Explained> Explain(SessionStart start, const std::vector<int>& group_of_place);

// With all that is found, poses too: of a sensor that moved those before and after; moves are added to `moved`, the one that explains most first.
[[nodiscard]] Explained ExplainAll(Explained now, std::vector<SensorMovedWithin>& moved);

}  // namespace rigcal::calib::joint
