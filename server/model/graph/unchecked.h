// Which measurements of a graph nothing else could show to be wrong.
#pragma once

#include <set>

#include "server/model/graph/graph.h"

namespace rigcal {

// Edges of the solution whose residual is zero whatever they measured: no loop contains them, the others do not see
// what they see, or all errors that could show are shared. As far as the solution says: without a jackknife and without
// influences (large graphs) only a graph without any redundancy is known to be unchecked.
[[nodiscard]] std::set<EdgeId> UncheckedEdges(const GraphSolution& solution);

}  // namespace rigcal
