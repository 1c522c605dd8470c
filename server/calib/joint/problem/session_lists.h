// The sensors, lenses, boards and captures of a session as lists of its problem, before anything has a place.
#pragma once

#include <map>
#include <set>

#include "server/calib/joint/problem/session_start.h"

namespace rigcal::calib::joint {

struct SessionLists {
  SessionStart start;  // without places, frames that stand still and looks; no reference where its pose is not known
  std::map<SensorId, int> lens_of_camera;
};
// Sensors whose pose is not known, and `left_out`, are in none of them.
[[nodiscard]] SessionLists ListsOf(const SessionViews& views, const std::set<SensorId>& left_out);

// kNone: it is none of the problem's. Of one that was moved the first.
[[nodiscard]] int IndexOf(const SessionProblem& problem, const SensorId& sensor);

}  // namespace rigcal::calib::joint
