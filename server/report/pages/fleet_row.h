// One robot in the list of all.
#pragma once

#include "server/model/robots/robot_summary.h"
#include "server/report/frame/page.h"

namespace rigcal::report {

// fleet.tpl's ROW, as of `now`. What is not known of it is not said. `has_places`: the list has a column for rig models
// and sites.
void FillFleetRow(Dictionary& row, const RobotSummary& robot, Stamp now, bool has_places);

}  // namespace rigcal::report
