// Merged edges (edges/merged_edge.h): what comes into one, whether it fits, and what it is in the graph; and which
// edges of a robot are merged.
#pragma once

#include <map>
#include <string>
#include <tuple>
#include <vector>

#include "server/model/edges/merged_edge.h"

namespace rigcal::graph {

// Two edges of one pair, along the directions that both see: false at odds below 1e-6 by chance. `between`: covariance
// by which the pose of an edge scatters from visit to visit, beyond its own uncertainty (right tangent at b).
[[nodiscard]] bool Agree(const Edge& x, const Edge& y, const Matrix6d& between = Matrix6d::Zero());
[[nodiscard]] bool Agree(const MergedEdge& merged, const Edge& edge, const Matrix6d& between = Matrix6d::Zero());

// Adds a good edge of the pair: pose, information, given constants and the scatter of its own score. `between`: as of
// Agree; what it makes the merged edge less sure by.
void Add(const Edge& edge, Stamp measured_at, MergedEdge& merged, const Matrix6d& between = Matrix6d::Zero());

// The same edge with a covariance more that covers what it is off from the merged one, and `between`; without block
// vectors and given constants.
[[nodiscard]] Edge AsUnsureAsOff(const Edge& edge, const MergedEdge& merged, const Matrix6d& between);

using MeasuredPair = std::tuple<SensorId, SensorId, std::string>;  // frames and method
// What edges share that are merged with each other.
[[nodiscard]] inline MeasuredPair PairOf(const Edge& edge) { return {edge.frame_a, edge.frame_b, edge.method}; }
using MergedPairs = std::map<MeasuredPair, MergedEdge>;

// As an edge of the graph: blocks that scatter as theirs do, unless they are not asked for, and contributions of the
// given constants. Its id is that of its pose, information and count: documents of revisions refer to it by that.
[[nodiscard]] Edge EdgeOf(const MergedEdge& merged, const RobotId& robot, bool blocks = true);

// A window over the edges of a robot: the newest stay as they are, the older ones of a pair and method become one edge.
// Parallel edges are what a quadratic cost adds up exactly: poses, covariances and the jackknife through the graph stay
// what they are with all of them, but for the curvature of SE(3) over the edges' errors.
struct Merge {
  std::vector<MergedEdge> merged;  // by frames and method
  std::vector<EdgeId> taken;       // edges that count in them now or are past, and were in the window before
};

constexpr std::size_t kEdgesKeptOfPair = 8;
constexpr std::size_t kMergedPartsMax = 4;
// Edges that were pushed as finished results. Takes good ones into `before`, the oldest first, and leaves the newest
// `kept` of each pair and method. Where these scatter by more than they say (scatter_of_most.h), what is taken makes
// the merged edge less sure. What contradicts the merged edge, with the scatter, is told for as long as nobody settles
// it: the newest `kept` of such edges stay too; where there are more, the sensor was moved, and those after the move
// become a merged edge beside the one of before (MergedEdge::part). Of such parts there are kMergedPartsMax at most:
// beyond, and of edges that do not agree with each other either, the oldest counts in the nearest part as one that is
// as uncertain as it is off. So of a pair there are 2 `kept` edges and kMergedPartsMax merged ones at most, however
// many came. A first part begins with an edge that half of those agree with that were measured next. Of those that are
// past with their sensor (retired, remounted) the newest `kept` stay too, and the others leave the window.
// `measured_at` of each edge of `edges`; merged edges among these are passed over. `before` by part. Deterministic for
// any order of `edges`.
[[nodiscard]] Merge MergeOlderEdges(const std::vector<MergedEdge>& before, const std::vector<Edge>& edges,
                                    const std::map<EdgeId, Stamp>& measured_at, std::size_t kept = kEdgesKeptOfPair);

constexpr std::size_t kSessionsKept = 8;
// Edges of sessions, a session at a time, as its pairs share captures: likewise takes all that were captured before the
// newest `kept` with a good edge. One of which any edge contradicts what it would become part of stays whole; of more
// than `kept` such sessions the oldest is taken all the same, those edges as ones that are as uncertain as they are
// off. So 2 `kept` sessions stay at most. What failed in a session that is taken, or is past, leaves the window with
// it.
[[nodiscard]] Merge MergeOlderSessions(const std::vector<MergedEdge>& before, const std::vector<Edge>& edges,
                                       const std::map<EdgeId, Stamp>& measured_at, std::size_t kept = kSessionsKept);

}  // namespace rigcal::graph
