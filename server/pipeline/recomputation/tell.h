// What came of a re-computation, and how far it is.
#pragma once

#include <string>

#include "server/formats/answers/parameters.h"
#include "storage/store.h"

namespace rigcal::pipeline {

// READ. Verb recomputation: `run` (its number; else the newest), `limit` (0 to 1000 robots, and sessions that were
// left; else 100). kNotFound where there is no such run.
[[nodiscard]] Result<std::string> TellRecomputation(storage::Store& store, const formats::Parameters& parameters);

}  // namespace rigcal::pipeline
