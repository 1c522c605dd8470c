// Which loops of edges a graph has.
#pragma once

#include <vector>

#include "server/graph/solve/problem.h"

namespace rigcal::graph {

struct WalkStep {
  std::size_t constraint = 0;
  bool forward = true;  // from i to j
};
using Walk = std::vector<WalkStep>;
// The vertex at which a step starts.
[[nodiscard]] int StartOf(const Problem& problem, const WalkStep& step);

struct CycleWalks {
  std::vector<Walk> walks;  // no two of the same edges
  bool complete = true;     // false: longer loops, or triangles, were left out
};

// The loop of every edge outside a spanning tree, then triangles; short loops first, `steps_max` steps in all. The tree
// takes a rough edge only where no surer ones lead, so that what sure edges disagree in shows in loops of sure edges
// alone: a loop over a rough one is open by as much as that errs. Of edges that are alike it has the fewest hops.
[[nodiscard]] CycleWalks WalksOf(const Problem& problem, std::size_t steps_max);

}  // namespace rigcal::graph
