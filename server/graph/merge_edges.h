// A window over the edges of a robot: of each pair and method the newest stay as they are, the older ones become one edge.
// Parallel edges are what a quadratic cost adds up exactly: poses, covariances and the jackknife through the graph stay
// what they are with all of them, but for the curvature of SE(3) over the edges' errors.
#pragma once

#include <map>
#include <vector>

#include "server/model/merged_edge.h"

namespace rigcal::graph {

struct Merge {
  std::vector<MergedEdge> merged;  // by frames and method
  std::vector<EdgeId> taken;       // edges that are in them now, and were not before
};
constexpr std::size_t kEdgesKeptOfPair = 8;
// Takes good edges that belong to no session into `before`, the oldest first, and leaves the newest `kept` of each pair and
// method. One that contradicts what it would become part of stays, so that it is told for as long as nobody settles it; merging
// begins with one that half of its pair's edges agree with.
// `measured_at` of each edge of `edges`; merged edges among these are passed over. Deterministic for any order of `edges`.
[[nodiscard]] Merge MergeOlderEdges(const std::vector<MergedEdge>& before, const std::vector<Edge>& edges,
                                    const std::map<EdgeId, Stamp>& measured_at, std::size_t kept = kEdgesKeptOfPair);

// As an edge of the graph: blocks that scatter as theirs do, contributions of the given constants. Its id is that of its content.
[[nodiscard]] Edge EdgeOf(const MergedEdge& merged, const RobotId& robot);

}  // namespace rigcal::graph
