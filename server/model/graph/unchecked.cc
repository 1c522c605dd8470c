#include "server/model/graph/unchecked.h"

namespace rigcal {

std::set<EdgeId> UncheckedEdges(const GraphSolution& solution) {
  std::set<EdgeId> taking_part, unchecked;
  for (const EdgeResidual& residual : solution.residuals) {
    if (!residual.in_solution) continue;
    taking_part.insert(residual.edge);
    if (solution.dof <= 0 || (residual.by_jackknife && residual.rank == 0)) unchecked.insert(residual.edge);
  }
  for (const EdgeInfluence& influence : solution.influences.edges)
    if (!influence.checked && taking_part.contains(influence.edge)) unchecked.insert(influence.edge);
  return unchecked;
}

}  // namespace rigcal
