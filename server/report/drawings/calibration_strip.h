// A small drawing of how a robot's calibrations followed each other, for one cell of a list.
#pragma once

#include "server/model/robots/robot_summary.h"
#include "server/report/frame/page.h"

namespace rigcal::report {

// {{#STRIP}}, with strip.tpl in it as {{>DRAWING}}: from the first calibration that is listed to `now`, above the worst
// edge of each as a dot, dashed at kOff_sigmas; below how old it was until the next one, dashed at the age that the
// policy allows. Nothing where there are not two.
void FillCalibrationStrip(Dictionary& cell, const RobotSummary& robot, Stamp now);
// "12 calibrations since 3 Jan 2026, at most 62 days apart; worst edge 0.4 to 3.2 sigma"; for who does not see it. Of
// at least two.
[[nodiscard]] std::string CalibrationStripText(const std::vector<CalibrationPoint>& calibrations);

}  // namespace rigcal::report
