// What is said of weak edges that take no part in a solution (graph/solve/weak_edges.h).
#pragma once

#include <set>
#include <vector>

#include "server/model/graph/graph.h"

namespace rigcal::fleet {

// Of each pair of `weak`, whose sensors others hold, the edge that is furthest from where these have them: why it takes
// no part, and by how much that is.
[[nodiscard]] std::vector<Diagnosis> NotesOnWeakEdges(const std::vector<Edge>& edges, const std::set<EdgeId>& weak,
                                                      const GraphSolution& solution);

// `edges` without weak ones of which the solution has no residual: they took no part in it.
[[nodiscard]] std::vector<Edge> WithoutWeakAside(std::vector<Edge> edges, const GraphSolution& solution);

}  // namespace rigcal::fleet
