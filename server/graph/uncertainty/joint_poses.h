// What a revision keeps so that the relative pose of two of its sensors is read, not derived.
#pragma once

#include <optional>
#include <vector>

#include "server/graph/solve/solve.h"
#include "server/graph/uncertainty/graph_jackknife.h"
#include "server/model/graph/joint_poses.h"

namespace rigcal::graph {

// At the solution's poses: the covariance of the fused sessions, and where these do not have all known sensors that of
// the graph, by the jackknife where it is available, else H^-1. None of more than kJointPosesMax sensors: a query
// derives it.
[[nodiscard]] JointPoses JointPosesOf(const Graph& graph, const GraphSolution& solution,
                                      const GraphJackknife& jackknife);

// Of the graph alone, of these sensors, which it places and none of which is its reference. Nothing where the graph
// gives no finite covariance of all of them.
[[nodiscard]] std::optional<JointCovariance> JointOfGraph(const Graph& graph, const GraphSolution& solution,
                                                          const GraphJackknife& jackknife,
                                                          const std::vector<SensorId>& sensors);

// Of the fused sessions alone, if any.
[[nodiscard]] JointPoses FusedPosesOf(const GraphSolution& solution, const SensorId& reference);

// T_a_b with its covariance, cross terms included (math/covariance.h: RelativeCovariance). Nothing where one of the two
// is not known or no covariance has both.
[[nodiscard]] std::optional<RelativePose> RelativeOf(const JointPoses& poses, const SensorId& a, const SensorId& b);

// Of those pairs whose sensors are both known: what RelativeOf says, also of more than kJointPosesMax sensors. `poses`:
// JointPosesOf these.
[[nodiscard]] PairCovariances CovariancesOfPairs(const std::vector<SensorPair>& pairs, const JointPoses& poses,
                                                 const Graph& graph, const GraphSolution& solution,
                                                 const GraphJackknife& jackknife);

}  // namespace rigcal::graph
