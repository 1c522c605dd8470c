// The three numbers of a robot's page: how old, how certain, how far off.
#pragma once

#include "server/model/robots/robot_summary.h"
#include "server/report/frame/page.h"

namespace rigcal::report {

// Of its newest revision, each beside its limit; where its verdict asks for something, what decided it first; nothing
// of a robot that has none. Ages are as of `now`.
void FillRobotFigures(Dictionary& page, const RobotSummary& robot, Stamp now);

}  // namespace rigcal::report
