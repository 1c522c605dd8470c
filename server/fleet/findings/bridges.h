// Which sensors and edges no loop of the graph contains.
#pragma once

#include <set>
#include <vector>

#include "server/model/graph/graph.h"

namespace rigcal::fleet {

struct Bridges {
  std::vector<SensorId> sensors;  // known, but a bridge separates them from the reference: no second path. Sorted
  std::set<EdgeId> edges;         // without any of these the graph falls apart
};
// Of good edges between sensors whose pose is known.
[[nodiscard]] Bridges FindBridges(const std::vector<Edge>& edges, const GraphSolution& solution);

}  // namespace rigcal::fleet
