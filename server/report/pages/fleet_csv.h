// The list of robots as a spreadsheet takes it: a heading, and a row for each.
#pragma once

#include <string>

#include "server/model/robots/robot_summary.h"

namespace rigcal::report {

// The names of FleetCsvRow's columns, with its line end.
[[nodiscard]] std::string FleetCsvHeading();
// Times in UTC; empty where nothing is known. The status is as of `now`.
[[nodiscard]] std::string FleetCsvRow(const RobotSummary& robot, Stamp now);

}  // namespace rigcal::report
