#include "server/pipeline/robots/unknown_names.h"

#include <algorithm>

#include "server/base/limits.h"
#include "server/base/near_names.h"
#include "server/base/text.h"
#include "storage/fleet/robot_summary.h"
#include "storage/revisions/revision_poses.h"
#include "storage/revisions/revisions.h"
#include "storage/sessions/retired.h"
#include "storage/sessions/sessions.h"
#include "storage/settings/policies.h"

namespace rigcal::pipeline {
namespace {

constexpr int kModelsComparedMax = 1'000;

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

Result<std::set<SensorId>> LoadSensorNames(storage::Store& store, const RobotId& robot) {
  RIGCAL_ASSIGN(const auto listed, storage::LoadListedSensors(store, robot));
  RIGCAL_ASSIGN(const auto retired, storage::LoadRetiredSensors(store, robot));
  std::set<SensorId> sensors(listed.begin(), listed.end());
  std::erase_if(sensors, [&](const SensorId& sensor) { return retired.contains(sensor); });
  RIGCAL_ASSIGN(const auto newest, storage::LoadRevisionSummary(store, robot, 0));
  if (!newest) return sensors;
  RIGCAL_ASSIGN(const auto poses, storage::LoadRevisionPoses(store, {robot, newest->number}));
  if (!poses) return sensors;
  for (const auto& [sensor, pose] : poses->T_ref_sensor)
    if (!retired.contains(sensor)) sensors.insert(sensor);
  return sensors;
}

Error UnknownSensor(const RobotId& robot, const SensorId& name, const std::vector<SensorId>& known) {
  return {ErrorCode::kNotFound,
          "robot '" + robot.str() + "' has no sensor '" + name.str() + "'" +
              Suggestion(NearestNames(name.str(), TextsOf(known))),
          "`rigcal show " + robot.str() + "` lists its sensors."};
}

Error UnknownModel(storage::Store& store, const std::string& name) {
  const auto known = storage::LoadRigModels(store, kModelsComparedMax);
  if (!known) return known.error();
  return {ErrorCode::kNotFound, "no session is of rig model " + Quoted(name) + Suggestion(NearestNames(name, *known)),
          "Correct the name, or say with --new-model that its sessions are to come."};
}

Error UnknownSite(storage::Store& store, const std::string& name) {
  const auto robots = storage::LoadSummaries(store, RobotId(), std::nullopt, Stamp());
  if (!robots) return robots.error();
  std::set<std::string> sites;
  for (const RobotSummary& robot : *robots)
    if (!robot.site.empty()) sites.insert(robot.site);
  return {ErrorCode::kNotFound,
          "no robot is at the site " + Quoted(name) +
              Suggestion(NearestNames(name, std::vector<std::string>(sites.begin(), sites.end()))),
          "Write it as session.yaml does, under conditions; `rigcal due --json` has the site of each robot."};
}

}  // namespace rigcal::pipeline
