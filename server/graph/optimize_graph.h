// From a start to a GraphSolution: optimum, what is observable, marginals, residuals, errors before and after.
#pragma once

#include "server/graph/observability.h"
#include "server/graph/solve.h"

namespace rigcal::graph {

[[nodiscard]] GlobalError MeanSquares(const std::vector<Vector6d>& residuals);

// The optimum with the free directions held, and the factor of H at it.
struct Settled {
  Optimum optimum;
  Observability observability;
};
[[nodiscard]] Settled Settle(const Problem& problem, const Poses& start, BlockCholesky<6>& cholesky,
                             int iterations_max);

// E_global before is that of `tree_residuals`, by constraint.
[[nodiscard]] GraphSolution OptimizeGraph(const Graph& graph, const Problem& problem,
                                          const std::vector<Vector6d>& tree_residuals, const Poses& start,
                                          const SolveOptions& options);
// A graph whose reference is not among its sensors, or that has no sensors: nothing is known.
[[nodiscard]] GraphSolution WithoutReference(const Graph& graph, const Problem& problem);

}  // namespace rigcal::graph
