// One merged edge (model/merged_edge.h): what comes into it, whether it fits, and what it is in the graph.
#pragma once

#include <map>
#include <string>
#include <tuple>
#include <vector>

#include "server/model/merged_edge.h"

namespace rigcal::graph {

// Two edges of one pair, along the directions that both see: false at odds below 1e-6 by chance. `between`: covariance by which
// the pose of an edge scatters from visit to visit, beyond its own uncertainty (right tangent at b).
[[nodiscard]] bool Agree(const Edge& x, const Edge& y, const Matrix6d& between = Matrix6d::Zero());
[[nodiscard]] bool Agree(const MergedEdge& merged, const Edge& edge, const Matrix6d& between = Matrix6d::Zero());

// Adds a good edge of the pair: pose, information, given constants and the scatter of its own score.
void Add(const Edge& edge, Stamp measured_at, MergedEdge& merged);

using MeasuredPair = std::tuple<SensorId, SensorId, std::string>;  // frames and method
// What edges share that are merged with each other.
[[nodiscard]] inline MeasuredPair PairOf(const Edge& edge) { return {edge.frame_a, edge.frame_b, edge.method}; }
using MergedPairs = std::map<MeasuredPair, MergedEdge>;
// Adds the good edges of a session to those of its pairs, and what they have in common as columns of their scores.
void AddSession(const std::vector<const Edge*>& good, Stamp captured_at, MergedPairs& merged);

// As an edge of the graph: blocks that scatter as theirs do, unless they are not asked for, and contributions of the given
// constants. Its id is that of its pose, information and count: documents of revisions refer to it by that.
[[nodiscard]] Edge EdgeOf(const MergedEdge& merged, const RobotId& robot, bool blocks = true);

}  // namespace rigcal::graph
