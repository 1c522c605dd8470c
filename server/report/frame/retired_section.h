// Sensors that are gone from the robot, and how things are taken out and brought back: what a person copies.
#pragma once

#include "server/model/approval/standing.h"
#include "server/model/edges/edge.h"
#include "server/report/frame/page.h"

namespace rigcal::report {

// {{#GONE}} with WHY and COMMAND, for each.
void FillGone(Dictionary& page, const RobotId& robot, const std::vector<RetiredSensor>& gone);
// Neither past already, nor put together of others.
[[nodiscard]] bool HasWayOut(const Edge& edge);
inline constexpr std::size_t kWaysOutMax = 200;  // of a list
// {{#RETIRE}} with COMMAND.
void FillRetire(Dictionary& row, const std::string& command);

}  // namespace rigcal::report
