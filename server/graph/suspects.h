// Who is to blame where edges contradict each other. Nothing is dropped: the solution stays that of all edges.
#pragma once

#include "server/graph/robust_optimum.h"
#include "server/graph/solve.h"

namespace rigcal::graph {

struct SuspectOptions {
  double probability = 0.999;  // that a graph of good edges has no suspect
};

// Edges that the robust optimum rejects; sensors whose edges fall into two groups of one mind each: rejected edges of
// two neighbours or more that imply one and the same pose, or half of a sensor's edges.
[[nodiscard]] Suspects FindSuspects(const Graph& graph, const GraphSolution& solution,
                                    const SuspectOptions& options = {});

// The split of a robust optimum into suspects.
[[nodiscard]] Suspects SuspectsOf(const Graph& graph, const Problem& problem, const RobustOptimum& robust);

}  // namespace rigcal::graph
