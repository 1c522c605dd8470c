// READ: names that are not known, and which known ones they may mean (base/near_names.h).
#pragma once

#include <set>
#include <string>
#include <vector>

#include "server/base/ids.h"
#include "storage/store.h"

namespace rigcal::pipeline {

// Of up to kRobotsComparedMax robots on each side of `name` in the order of names, and in larger fleets also of all
// that are one edit away: a slip is found in any fleet, a name two edits away where it stands near.
[[nodiscard]] Result<std::vector<RobotId>> LoadNearRobots(storage::Store& store, const RobotId& name);

// Of the newest revision those with a pose, if it keeps its poses beside its document; and those that sessions list,
// without those that were retired.
[[nodiscard]] Result<std::set<SensorId>> LoadSensorNames(storage::Store& store, const RobotId& robot);

// kNotFound: "robot 'maper-01' is not known: did you mean mapper-01?"; or why the store could not say.
[[nodiscard]] Error UnknownRobot(storage::Store& store, const RobotId& name);
// Likewise, of the robot's own.
[[nodiscard]] Error UnknownSensor(const RobotId& robot, const SensorId& name, const std::vector<SensorId>& known);
// Likewise, of a rig model that no session names.
[[nodiscard]] Error UnknownModel(storage::Store& store, const std::string& name);
// Likewise, of a site at which no robot's newest session was taken.
[[nodiscard]] Error UnknownSite(storage::Store& store, const std::string& name);

}  // namespace rigcal::pipeline
