// The graph's cost written once more, on rotation vectors, differentiated automatically and solved by Ceres: an oracle.
#pragma once

#include <array>
#include <vector>

#include "server/graph/solve/solve.h"

namespace rigcal::graph {

struct CeresSolution {
  std::vector<std::array<double, 7>> poses;
  double cost = 0.0;
};

CeresSolution SolveWithCeres(const Graph& graph, const GraphSolution& start);

}  // namespace rigcal::graph
