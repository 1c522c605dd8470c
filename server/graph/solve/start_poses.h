// Poses from which a solve starts, and those of a stored solution, as the numerical core wants them.
#pragma once

#include <optional>

#include "server/graph/solve/linearize.h"

namespace rigcal::graph {

// The start that people can follow, composed along the most certain edges: minimum spanning tree under weight
// 1/2 log det C; rank-deficient edges last (higher rank first); ties by edge id.
[[nodiscard]] Poses SpanningTreePoses(const Problem& problem);

// The chordal start: all rotations at once by linear least squares on 3x3 matrices, projected onto SO(3), then all
// translations (Martinec & Pajdla 2007; Carlone et al. 2015). It does not drift along chains as a tree does. Empty if a
// linear system cannot be factored.
[[nodiscard]] std::optional<Poses> ChordalPoses(const Problem& problem);

// A solution's, by vertex of `problem`. Sensors that it knows nothing of hang on the others by their best edges.
[[nodiscard]] Poses SolvedPoses(const Graph& graph, const Problem& problem, const GraphSolution& solution);

}  // namespace rigcal::graph
