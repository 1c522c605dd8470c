// One merged edge (model/merged_edge.h): what comes into it, whether it fits, and what it is in the graph.
#pragma once

#include "server/model/merged_edge.h"

namespace rigcal::graph {

// Two edges of one pair, along the directions that both see: false at odds below 1e-6 by chance.
[[nodiscard]] bool Agree(const Edge& x, const Edge& y);
[[nodiscard]] bool Agree(const MergedEdge& merged, const Edge& edge);

// Adds a good edge of the pair: pose, information, given constants and the scatter of its own score.
void Add(const Edge& edge, Stamp measured_at, MergedEdge& merged);

// As an edge of the graph: blocks that scatter as theirs do, contributions of the given constants. Its id is that of its
// content.
[[nodiscard]] Edge EdgeOf(const MergedEdge& merged, const RobotId& robot);

}  // namespace rigcal::graph
