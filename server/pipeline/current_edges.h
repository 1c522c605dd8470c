// READ: the edges of a robot as its next revision sees them.
#pragma once

#include <vector>

#include "server/model/edge.h"
#include "server/model/standing.h"
#include "storage/store.h"

namespace rigcal::pipeline {

// All edges, good and failed, sorted by id. Those that were retired, those of a superseded session, and those of a
// sensor that was remounted since are failed, with that as their only diagnosis (IsPast). Block vectors only on demand.
// Call within one Read.
[[nodiscard]] Result<std::vector<Edge>> LoadCurrentEdges(storage::Store& store, const RobotId& robot, bool blocks);
// As it is shown where it was retired.
void Retire(const Word& word, Edge& edge);

}  // namespace rigcal::pipeline
