// What is said of weak edges that take no part in a solution (graph/solve/weak_edges.h).
#pragma once

#include <set>
#include <vector>

#include "server/model/graph/graph.h"

namespace rigcal::fleet {

// Of each of `weak`, whose sensors others hold: why it takes no part, and how far it is from where these have them.
[[nodiscard]] std::vector<Diagnosis> NotesOnWeakEdges(const std::vector<Edge>& edges, const std::set<EdgeId>& weak,
                                                      const GraphSolution& solution);

}  // namespace rigcal::fleet
