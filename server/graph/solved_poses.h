// A stored solution's poses as the numerical core wants them.
#pragma once

#include "server/graph/linearize.h"

namespace rigcal::graph {

// By vertex of `problem`. Sensors that the solution does not know hang on the known ones by their best edges.
[[nodiscard]] Poses SolvedPoses(const Graph& graph, const Problem& problem, const GraphSolution& solution);


// H at these poses, the directions that edges leave open held (Observe), factored; null where it is not positive definite
// or would fill in.
[[nodiscard]] std::unique_ptr<BlockCholesky<6>> FactorAt(const Problem& problem, const Poses& T_ref);

}  // namespace rigcal::graph
