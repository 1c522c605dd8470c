// What a solution rests on: edges that contradict the others, what each edge does to the result, how well loops close.
#pragma once

#include "server/graph/solve/solve.h"
#include "server/graph/uncertainty/graph_jackknife.h"
#include "server/model/graph/other_paths.h"

namespace rigcal::graph {

// Who is to blame where edges contradict each other. Nothing is dropped: the solution stays that of all edges. Edges
// that the robust optimum rejects; sensors whose edges fall into two groups of one mind each: rejected edges of two
// neighbours or more that imply one and the same pose, or half of a sensor's edges. A graph of good edges has no
// suspect with a probability of 0.999.
[[nodiscard]] Suspects FindSuspects(const Graph& graph, const GraphSolution& solution);

// What a single edge does to the result: the solution without it, to first order. Work grows with the square of the
// sensors and with sensors times edges.
constexpr std::size_t kInfluenceSensorsMax = 150;
constexpr std::size_t kInfluenceEdgesMax = 1500;
// Sigmas are those that `solution` states. Not judged, with a sentence why, beyond the limits above or without
// convergence.
[[nodiscard]] Influences InfluenceOfEdges(const Graph& graph, const GraphSolution& solution);
// What the others know of each edge; of none where InfluenceOfEdges does not judge.
[[nodiscard]] OtherPaths OtherPathsOf(const Graph& graph, const GraphSolution& solution);

// How well loops of edges close: what a person checks by hand.
struct CycleOptions {
  std::size_t steps_max = 3000;  // of all walks together: what a graph of thousands of sensors may cost
  std::size_t worst_max = 20;    // cycles that are given back as the worst
};
// The loop of every edge that is not in a spanning tree of the surest edges (cycle_walks.h), then every triangle. Each
// is judged by the covariance of its own residual: blocks and given constants that its edges share count once, through
// the whole loop. What any of its edges leaves open is no part of the residual: the loop is tested in the directions
// that all of them measure, if there are any. Loops that were left out are named in `why_not`.
[[nodiscard]] Cycles JudgeCycles(const Graph& graph, const BlocksByEdge& blocks, const CycleOptions& options = {});

}  // namespace rigcal::graph
