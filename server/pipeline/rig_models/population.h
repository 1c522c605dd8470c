// READ: how the sensors of a rig model sit on its robots (server/fleet/population/): what the calibrations say that are
// in use.
#pragma once

#include <string>

#include "server/formats/answers/parameters.h"
#include "server/model/robots/population.h"
#include "storage/store.h"

namespace rigcal::pipeline {

// Of robots whose newest session is of this rig model. Told in the model's reference; where nobody has set the model,
// in the sensor that is the reference of most of them, of several the first by name. kNotFound for a model that nobody
// knows.
[[nodiscard]] Result<Population> LoadPopulation(storage::Store& store, const std::string& rig_model);

// Verb population: `model`.
[[nodiscard]] Result<std::string> TellPopulation(storage::Store& store, const formats::Parameters& parameters);

}  // namespace rigcal::pipeline
