// How well loops of edges close: what a person checks by hand.
#pragma once

#include "server/graph/graph_jackknife.h"

namespace rigcal::graph {

struct CycleOptions {
  std::size_t steps_max = 3000;  // of all walks together: what a graph of thousands of sensors may cost
  std::size_t worst_max = 20;    // cycles that are given back
  double probability = 0.999;    // that all cycles of a graph of good edges close
};

// The loop of every edge that is not in a spanning tree of fewest hops, then every triangle. Each is judged by the
// covariance of its own residual: blocks and given constants that its edges share count once, through the whole loop.
// Loops that were left out are named in `why_not`.
[[nodiscard]] Cycles JudgeCycles(const Graph& graph, const BlocksByEdge& blocks, const CycleOptions& options = {});

}  // namespace rigcal::graph
