// What a revision keeps so that the relative pose of two of its sensors is read where one is known in part only.
#pragma once

#include <optional>

#include "server/graph/solve/solve.h"
#include "server/graph/uncertainty/graph_jackknife.h"
#include "server/model/graph/joint_poses.h"

namespace rigcal::graph {

// Of all that have a place, at their poses by pairs (FusedPose), with the covariance of the graph: by the jackknife
// where it is available, else H^-1. Nothing where no sensor is known in part only, of more than kJointPosesMax sensors,
// and where the graph gives no covariance of them.
[[nodiscard]] std::optional<PlacedPoses> PlacedPosesOf(const Graph& graph, const GraphSolution& solution,
                                                       const GraphJackknife& jackknife);

// T_a_b with its covariance, cross terms included, and what is open of it: none where both are open in the same way.
// Nothing where one of the two has no place.
[[nodiscard]] std::optional<RelativePose> RelativeOf(const PlacedPoses& poses, const SensorId& a, const SensorId& b);

// The same solution with the poses of the graph of pairs, in whose place fused ones stand.
[[nodiscard]] GraphSolution WithPosesByPairs(GraphSolution solution);

}  // namespace rigcal::graph
