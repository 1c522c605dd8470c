#include "client/new_robot.h"

#include "client/table.h"

namespace rigcal::client {

Status CheckNewRobot(Connection& connection, const RobotId& robot, std::chrono::milliseconds timeout) {
  const auto told = connection.AskDocument("known_robot", JsonObject({{"robot", robot.str()}}), timeout);
  if (!told || (*told)["known"].Flag(true) || (*told)["slip_of"].size() == 0) return {};
  const std::string known = Plain((*told)["slip_of"][0].Text());
  return Fail(
      ErrorCode::kConflict,
      "robot '" + robot.str() + "' is new, and " + known + " is known: push with --new-robot if it is another robot",
      "Else correct the name; nothing was sent");
}

}  // namespace rigcal::client
