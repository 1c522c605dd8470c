// What a single edge does to the result: the solution without it, to first order.
#pragma once

#include "server/graph/solve.h"

namespace rigcal::graph {

// Work grows with the square of the sensors and with sensors times edges.
constexpr std::size_t kInfluenceSensorsMax = 150;
constexpr std::size_t kInfluenceEdgesMax = 1500;

// Sigmas are those that `solution` states. Not judged, with a sentence why, beyond the limits above or without
// convergence.
[[nodiscard]] Influences InfluenceOfEdges(const Graph& graph, const GraphSolution& solution);

}  // namespace rigcal::graph
