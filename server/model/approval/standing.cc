#include "server/model/approval/standing.h"

namespace rigcal {
namespace {

constexpr std::size_t kDigitsTyped = 16;
constexpr const char* kReasonToFillIn = " --reason \"WHY\"";

std::string OfRobot(const RobotId& robot, const SensorId& sensor) { return sensor.str() + " --robot " + robot.str(); }

}  // namespace

std::string RetiredText(const Word& word) {
  constexpr std::size_t kDateDigits = 10;
  std::string reason = word.reason;
  while (!reason.empty() && reason.back() == '.') reason.pop_back();
  return "retired on " + ToIso(word.at).substr(0, kDateDigits) + " by " + word.who +
         (reason.empty() ? "" : ": " + reason);
}

std::string RetiredText(const RetiredSensor& gone) { return gone.sensor.str() + " was " + RetiredText(gone.word); }

std::string RetireCommand(const EdgeId& edge) {
  return "rigcal retire " + edge.str().substr(0, kDigitsTyped) + kReasonToFillIn;
}

std::string RetireCommand(const SessionId& session) {
  return "rigcal retire " + session.str().substr(0, kDigitsTyped) + kReasonToFillIn;
}

std::string RetireCommand(const RobotId& robot, const SensorId& sensor) {
  return "rigcal retire " + OfRobot(robot, sensor) + kReasonToFillIn;
}

std::string RestoreCommand(const EdgeId& edge) { return "rigcal restore " + edge.str().substr(0, kDigitsTyped); }

std::string RestoreCommand(const SessionId& session) {
  return "rigcal restore " + session.str().substr(0, kDigitsTyped);
}

std::string RestoreCommand(const RobotId& robot, const SensorId& sensor) {
  return "rigcal restore " + OfRobot(robot, sensor);
}

std::string BringsBack(const std::string& restore_command) { return "`" + restore_command + "` brings it back."; }

}  // namespace rigcal
