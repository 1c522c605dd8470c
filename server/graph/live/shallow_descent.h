// Updates of graphs whose vertices are all few edges from the reference, and of small ones: Gauss-Newton from the poses
// at hand, with a factor that is renewed from the first column that changed and kept while it serves. Up to
// kBlocksDenseMax free vertices the factor is dense; beyond, steps are solved by conjugate gradients. Secant pairs
// (`gauss_newton.h`) make up for what an old factor does not know.
#pragma once

#include <memory>

#include "server/graph/live/live_state.h"

namespace rigcal::graph {

// The factor of a state's H, as far as it is known. Without one yet, nothing is.
struct ShallowFactor {
  std::unique_ptr<BlockCholesky<6>> solver;  // reads pattern and H of the state
  int block_count = 0;                       // of the factor at hand
  int dirty_from = 0;                        // first block column of H that it does not know
  bool stale = true;                         // H is to be linearised anew before it is used
};

// H has been given what this constraint adds.
void TouchColumns(const Constraint& constraint, ShallowFactor& factor);

// Poses to the optimum of the state whose last constraint is new, as near as the budget asks. False, with the state in
// between, if a step is large, gains do not shrink, or H is not positive definite: then the batch decides.
[[nodiscard]] bool DescendWithNewest(const UpdateBudget& budget, ShallowFactor& factor, LiveState& state,
                                     UpdateWork& work);
// The same where a constraint has left, with the gradient made anew. `factor` is to be stale.
[[nodiscard]] bool DescendWithout(const UpdateBudget& budget, ShallowFactor& factor, LiveState& state,
                                  UpdateWork& work);

}  // namespace rigcal::graph
