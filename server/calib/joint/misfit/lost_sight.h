// Lidars that from one capture on see no board where everyone else says that one is. Boards are looked for near there
// only, so a lidar that was moved by more than that has no look from then on that the scan for moves could judge.
#pragma once

#include "server/calib/joint/problem/session_start.h"
#include "server/model/sessions/session_estimate.h"

namespace rigcal::calib::joint {

// Of n captures in which a lidar's clouds were looked through for a board whose place is known, u without one there,
// the last r of all among these: by chance C(n - r, u - r) / C(n, u), for any of the lidars. Told from three captures
// on, below kMovedOdds, and where the lidar found what it should in four of five captures before. By sensor.
[[nodiscard]] std::vector<LostSight> LostSightsTold(const SessionStart& start);

}  // namespace rigcal::calib::joint
