// All edges of a virtual rig from its observations, without a picture: as the pipeline makes them.
#pragma once

#include <vector>

#include "client/sim/visit/observe.h"
#include "server/graph/solve/solve.h"
#include "server/model/edges/edge.h"

namespace rigcal::sim {

struct RigEdgesOptions {
  bool lidar_pairs = true;  // these need whole clouds, which take most of the time
};
// Of every pair that is calibrated, in the order of the session, with the ids that the store would give.
[[nodiscard]] std::vector<Edge> RigEdges(const Experiment& experiment, const Observations& seen,
                                         const RigEdgesOptions& options = {});

struct SolvedRig {
  Graph graph;
  GraphSolution solution;  // with the covariances of the jackknife through the graph
};
[[nodiscard]] SolvedRig SolveRig(const Experiment& experiment, const std::vector<Edge>& edges);
// Log(T^-1 T_true) of what an edge measures.
[[nodiscard]] Vector6d EdgeError(const Experiment& experiment, const Edge& edge);

}  // namespace rigcal::sim
