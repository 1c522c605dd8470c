// Which loops of edges a graph has: the loop of every edge outside a spanning tree of fewest hops, then triangles.
#pragma once

#include <vector>

#include "server/graph/problem.h"

namespace rigcal::graph {

struct WalkStep {
  std::size_t constraint = 0;
  bool forward = true;  // from i to j
};
using Walk = std::vector<WalkStep>;

struct CycleWalks {
  std::vector<Walk> walks;  // no two of the same edges
  bool complete = true;     // false: longer loops, or triangles, were left out
};

// Short loops first, `steps_max` steps in all.
[[nodiscard]] CycleWalks WalkCycles(const Problem& problem, std::size_t steps_max);

// The vertex at which a step starts, and where it ends.
[[nodiscard]] int StartOf(const Problem& problem, const WalkStep& step);
[[nodiscard]] int EndOf(const Problem& problem, const WalkStep& step);

}  // namespace rigcal::graph
