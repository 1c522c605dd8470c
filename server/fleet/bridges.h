// Which sensors no loop of the graph contains.
#pragma once

#include <vector>

#include "server/model/graph.h"

namespace rigcal::fleet {

// Known sensors that a bridge separates from the reference: no second path of edges checks their pose. Sorted.
[[nodiscard]] std::vector<SensorId> BehindBridges(const std::vector<Edge>& edges, const GraphSolution& solution);

}  // namespace rigcal::fleet
