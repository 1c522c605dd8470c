// Minimises the weighted cost: Gauss-Newton, with Levenberg-Marquardt damping only where a full step does not help.
#pragma once

#include <vector>

#include "server/graph/linearize.h"

namespace rigcal::graph {

// A coordinate of the step that is held, because no edge says anything about it.
struct Pin {
  int row = 0;  // of H
};

struct Optimum {
  Poses T_ref;
  std::vector<Vector6d> residuals;  // by constraint; empty if they are not at hand
  double cost = 0.0;
  int iterations = 0;
  bool converged = false;
};

// Converged: the next step would lower the cost by less than 1e-14 of it, or moves nothing by more than 1e-12.
[[nodiscard]] Optimum Optimize(const Problem& problem, const Poses& start, const std::vector<Pin>& pins,
                               BlockCholesky<6>& cholesky, int iterations_max);

// Stiffens the pinned coordinates; exact for everything that does not depend on them.
void AddPins(const std::vector<Pin>& pins, BlockMatrix<6>& H);

}  // namespace rigcal::graph
