// READ and WRITE: how the sensors of a rig model's robots scatter from visit to visit, from one row per robot and
// sensor (storage/fleet/visit_scatter.h) to what one more of them is held against (fleet/population/scatter_pool.h).
#pragma once

#include <string>

#include "server/model/graph/graph.h"
#include "storage/store.h"

namespace rigcal::pipeline {

// What other robots of the rig model with that reference scatter by; nothing of a robot without a rig model, nor where
// they are too few or too unlike. Call within Read.
[[nodiscard]] Result<PooledScatter> LoadPooledScatter(storage::Store& store, const RobotId& robot,
                                                      const std::string& rig_model, const SensorId& reference);

// Keeps what the robot's own visits tell, for others. Not of sensors that moved between visits, by the very test that
// holds a move against this scatter: until an epoch of them begins their visits tell of the move. Call inside Write.
[[nodiscard]] Status KeepVisitScatter(storage::Store& store, const RobotId& robot, const std::string& rig_model,
                                      const SensorId& reference, const GraphSolution& solution);

// By which a solution was fused.
[[nodiscard]] PooledScatter PooledScatterOf(const GraphSolution& solution);

}  // namespace rigcal::pipeline
