#include "server/pipeline/answers/names.h"

#include <set>
#include <sstream>

#include "server/base/limits.h"
#include "server/base/near_names.h"
#include "server/formats/answers/answers.h"
#include "server/pipeline/robots/asked.h"
#include "server/pipeline/robots/unknown_names.h"
#include "storage/sessions/sessions.h"

namespace rigcal::pipeline {
namespace {

using formats::Parameters;

// Empty where it is not there, or empty.
Result<std::string> PrefixOf(const Parameters& parameters) {
  const std::string prefix = parameters.Text("prefix").value_or("");
  if (!prefix.empty()) RIGCAL_TRY(CheckName("prefix", prefix));
  return prefix;
}

Result<std::set<Digest>> DigestsIn(const std::string& text) {
  std::set<Digest> digests;
  std::istringstream words(text);
  for (std::string word; words >> word;) {
    RIGCAL_ASSIGN(Digest digest, Digest::Parse(word));
    digests.insert(std::move(digest));
  }
  if (!digests.empty() && digests.size() <= limits::kDigestsAskedMax) return digests;
  return Fail(ErrorCode::kInvalidInput, "the parameter 'digests' has " + std::to_string(digests.size()) + " digests",
              "Ask for 1 to " + std::to_string(limits::kDigestsAskedMax) + " at once, with blanks between them.");
}

Result<std::string> TellRobotNames(const AnswerContext& context, const Parameters& parameters) {
  RIGCAL_ASSIGN(const std::string prefix, PrefixOf(parameters));
  RIGCAL_ASSIGN(auto robots, storage::LoadRobotNames(context.store, prefix, limits::kPageRowsMax + 1));
  const bool more = CutToPage(limits::kPageRowsMax, robots);
  return formats::WriteRobotNames(robots, more);
}

Result<std::string> TellSensorNames(const AnswerContext& context, const Parameters& parameters) {
  RIGCAL_ASSIGN(const RobotId robot, KnownRobot(context.store, parameters));
  RIGCAL_ASSIGN(const std::string prefix, PrefixOf(parameters));
  RIGCAL_ASSIGN(const auto all, LoadSensorNames(context.store, robot));
  std::vector<SensorId> sensors;
  for (const SensorId& sensor : all)
    if (sensor.str().rfind(prefix, 0) == 0) sensors.push_back(sensor);
  const bool more = CutToPage(limits::kPageRowsMax, sensors);
  return formats::WriteSensorNames(robot, sensors, more);
}

Result<std::string> TellKnownRobot(const AnswerContext& context, const Parameters& parameters) {
  RIGCAL_ASSIGN(const RobotId robot, RequiredId<RobotId>(parameters, "robot"));
  RIGCAL_ASSIGN(const bool is_known, storage::HasRobot(context.store, robot));
  if (is_known) return formats::WriteKnownRobot(robot, true, {});
  RIGCAL_ASSIGN(auto near, LoadNearRobots(context.store, robot));
  std::erase_if(near, [&](const RobotId& one) { return !IsSlip(robot.str(), one.str()); });
  return formats::WriteKnownRobot(robot, false, near);
}

Result<std::string> TellKnownFiles(const AnswerContext& context, const Parameters& parameters) {
  RIGCAL_ASSIGN(const RobotId robot, RequiredId<RobotId>(parameters, "robot"));
  RIGCAL_ASSIGN(const std::set<Digest> digests, DigestsIn(parameters.Text("digests").value_or("")));
  RIGCAL_ASSIGN(const auto held, storage::LoadHeldByAnother(context.store, robot, digests));
  if (!held) return formats::WriteKnownFiles(digests.size(), std::nullopt);
  return formats::WriteKnownFiles(
      digests.size(), formats::FilesOfAnother{held->robot, held->session, held->captured_at, held->contents});
}

}  // namespace

std::vector<VerbAnswer> NameVerbs() {
  return {{"robot_names", TellRobotNames},
          {"sensor_names", TellSensorNames},
          {"known_robot", TellKnownRobot},
          {"known_files", TellKnownFiles}};
}

}  // namespace rigcal::pipeline
