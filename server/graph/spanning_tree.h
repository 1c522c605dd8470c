// The start that people can follow: poses composed along the most certain edges.
#pragma once

#include <vector>

#include "server/graph/linearize.h"

namespace rigcal::graph {

// Minimum spanning tree under weight 1/2 log det C; rank-deficient edges last (higher rank first); ties by edge id.
[[nodiscard]] Poses SpanningTreePoses(const Problem& problem);
// The same, growing from the vertices that are placed already (`placed[v]`; vertex 0 always is). Their poses stay.
[[nodiscard]] Poses GrowTree(const Problem& problem, Poses T_ref, std::vector<bool> placed);

}  // namespace rigcal::graph
