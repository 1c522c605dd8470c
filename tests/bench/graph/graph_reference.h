// What graph_bench compares with and runs on: Ceres on the same cost, and random graphs.
#pragma once

#include <nlohmann/json.hpp>
#include <vector>

#include "server/model/edges/edge.h"
#include "server/model/graph/graph.h"

namespace rigcal::bench {

// A tree of sensors within a cube, then random further pairs; 5 mm and 0.3 degrees of noise per axis. Deterministic.
[[nodiscard]] std::vector<Edge> RandomEdges(std::size_t vertices, std::size_t edges, unsigned seed);

// {"total_ms", "iterations", "cost"} of Ceres (sparse normal Cholesky, one thread, wide trust region) from a
// breadth-first start of the first edges, problem set-up included. Sensors that are not connected take no part.
[[nodiscard]] nlohmann::json SolveWithCeres(const Graph& graph);

}  // namespace rigcal::bench
