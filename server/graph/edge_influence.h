// What a single edge does to the result: the solution without it, to first order.
#pragma once

#include <vector>

#include "server/graph/solve.h"

namespace rigcal::graph {

struct EdgeInfluence {
  EdgeId edge;
  bool checked = false;              // false: no other path between its sensors; then no numbers
  double t_squared = 0.0;            // of the edge against what the others say
  SensorId most_moved;               // by leaving the edge out, in its sigmas
  Vector6d move = Vector6d::Zero();  // Log(T_with^-1 T_without) of that sensor
  double move_sigmas = 0.0;          // sqrt(move^T C^-1 move), C the sensor's covariance with the edge
};

// By edge id; edges outside the solution are left out. Empty beyond kChecksSensorsMax sensors or without convergence.
[[nodiscard]] std::vector<EdgeInfluence> InfluenceOfEdges(const Graph& graph, const GraphSolution& solution);

}  // namespace rigcal::graph
