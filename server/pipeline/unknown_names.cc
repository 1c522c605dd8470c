#include "server/pipeline/unknown_names.h"

#include <algorithm>

#include "server/base/limits.h"
#include "server/base/near_names.h"
#include "storage/sessions.h"

namespace rigcal::pipeline {
namespace {

template <typename AnId>
std::vector<std::string> TextsOf(const std::vector<AnId>& ids) {
  std::vector<std::string> texts;
  for (const AnId& id : ids) texts.push_back(id.str());
  return texts;
}

std::vector<RobotId> RobotsCalled(std::vector<std::string> names) {
  std::vector<RobotId> robots;
  for (std::string& name : names) robots.emplace_back(std::move(name));
  return robots;
}

Result<std::vector<RobotId>> LoadComparedRobots(storage::Store& store, const RobotId& name) {
  RIGCAL_ASSIGN(auto robots, storage::LoadRobotsBeside(store, name, limits::kRobotsComparedMax));
  if (static_cast<std::int64_t>(robots.size()) < limits::kRobotsComparedMax) return robots;
  RIGCAL_ASSIGN(const auto near, storage::LoadRobotsNamed(store, RobotsCalled(NamesOneEditAway(name.str()))));
  robots.insert(robots.end(), near.begin(), near.end());
  std::sort(robots.begin(), robots.end());
  robots.erase(std::unique(robots.begin(), robots.end()), robots.end());
  return robots;
}

}  // namespace

Result<std::vector<RobotId>> LoadNearRobots(storage::Store& store, const RobotId& name) {
  RIGCAL_ASSIGN(const auto robots, LoadComparedRobots(store, name));
  return RobotsCalled(NearestNames(name.str(), TextsOf(robots)));
}

Error UnknownRobot(storage::Store& store, const RobotId& name) {
  const auto near = LoadNearRobots(store, name);
  if (!near) return near.error();
  return {ErrorCode::kNotFound, "robot '" + name.str() + "' is not known" + Suggestion(TextsOf(*near)),
          "`rigcal robots` lists those that are."};
}

Error UnknownSensor(const RobotId& robot, const SensorId& name, const std::vector<SensorId>& known) {
  return {ErrorCode::kNotFound,
          "robot '" + robot.str() + "' has no sensor '" + name.str() + "'" +
              Suggestion(NearestNames(name.str(), TextsOf(known))),
          "`rigcal show " + robot.str() + "` lists its sensors."};
}

}  // namespace rigcal::pipeline
