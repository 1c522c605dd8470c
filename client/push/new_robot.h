// Before a push: is the robot's name one that was meant, and are the files its own?
#pragma once

#include <chrono>
#include <vector>

#include "client/wire/connection.h"
#include "server/model/sessions/session.h"

namespace rigcal::client {

inline constexpr const char* kNewRobotHelp =
    "The name is right, though it is one slip away from a known robot's, or the files are those of another robot";

// One question to the server. The robot that it knows and of whose name this one is a slip, where it has never seen
// this one; else, and where it does not answer, empty.
[[nodiscard]] std::string SlipOf(Connection& connection, const RobotId& robot, std::chrono::milliseconds timeout);
// kConflict where there is such a robot. Good where it does not answer: a server may be older than the question, and a
// push itself waits for one.
[[nodiscard]] Status CheckNewRobot(Connection& connection, const RobotId& robot, std::chrono::milliseconds timeout);
// One more. kConflict where half or more of the pictures and clouds, of which some are looked at, are in a session of
// another robot. Good likewise.
[[nodiscard]] Status CheckWhoseFiles(Connection& connection, const RobotId& robot, const std::vector<Payload>& payloads,
                                     std::chrono::milliseconds timeout);

}  // namespace rigcal::client
