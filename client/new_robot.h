// Before a push: is the robot's name one that was meant?
#pragma once

#include <chrono>

#include "client/connection.h"
#include "server/base/ids.h"

namespace rigcal::client {

inline constexpr const char* kNewRobotHelp = "It is another robot, though its name is one slip away from a known one's";

// One question to the server. kConflict where it has never seen the robot and knows one of which the name is a slip.
// Good where it does not answer: a server may be older than the question, and a push itself waits for one.
[[nodiscard]] Status CheckNewRobot(Connection& connection, const RobotId& robot, std::chrono::milliseconds timeout);

}  // namespace rigcal::client
