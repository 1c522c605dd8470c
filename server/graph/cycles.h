// How well loops of edges close: what a person checks by hand.
#pragma once

#include <vector>

#include "server/graph/solve.h"

namespace rigcal::graph {

struct CycleResidual {
  std::vector<EdgeId> edges;      // in the order of the walk
  std::vector<SensorId> sensors;  // likewise; the walk starts and ends at the first
  Vector6d e = Vector6d::Zero();  // Log of the composed measurements, right tangent at the first sensor
  bool tested = false;            // false: an edge does not see every direction
  double statistic = 0.0;         // e^T C^-1 e, C composed of the edges' as independent
};

// The loop of every edge that is not in a spanning tree of fewest hops, then every triangle that is no such loop;
// at most `cycles_max`.
[[nodiscard]] std::vector<CycleResidual> FindCycles(const Graph& graph, std::size_t cycles_max = 10000);

}  // namespace rigcal::graph
