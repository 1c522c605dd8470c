// How the sensors of each robot scatter from visit to visit by its own visits (graph/visit_scatter.h): one row per
// robot and sensor, replaced when the robot is revised, so that what a rig model's robots have in common needs no look
// at their histories.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "server/model/graph/visit_scatter.h"
#include "storage/store.h"

namespace rigcal::storage {

// In the place of what the robot had, of whatever rig model; of no rig model nothing is kept. Sensors of less than two
// visits (no degrees of freedom) are left out. Call inside Write. kInvalidInput for numbers that are none.
[[nodiscard]] Status ReplaceVisitScatter(Store& store, const RobotId& robot, const std::string& rig_model,
                                         const SensorId& reference, const std::map<SensorId, VisitScatter>& scatter);

// Of the other robots of the rig model with that reference: by id, the first `robots_max`.
[[nodiscard]] Result<std::vector<std::map<SensorId, VisitScatter>>> LoadScatterOfOthers(
    Store& store, const RobotId& robot, const std::string& rig_model, const SensorId& reference, int robots_max);

}  // namespace rigcal::storage
