// How the sensors of a rig model sit on its robots (server/fleet/population/), by what the calibrations say that are in
// use; and how they scatter from visit to visit, from one row per robot and sensor (storage/fleet/visit_scatter.h) to
// what one more of them is held against (fleet/population/scatter_pool.h).
#pragma once

#include <string>

#include "server/formats/answers/parameters.h"
#include "server/model/graph/graph.h"
#include "server/model/robots/population.h"
#include "storage/store.h"

namespace rigcal::pipeline {

// READ. Of robots whose newest session is of this rig model. Told in the model's reference; where nobody has set the
// model, in the sensor that is the reference of most of them, of several the first by name. kNotFound for a model that
// nobody knows.
[[nodiscard]] Result<Population> LoadPopulation(storage::Store& store, const std::string& rig_model);

// Verb population: `model`.
[[nodiscard]] Result<std::string> TellPopulation(storage::Store& store, const formats::Parameters& parameters);

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
