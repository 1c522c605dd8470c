// Updates of graphs that are many edges deep, by a tree of cliques. Steps are taken with H as it was when its edges
// were linearised: a rigid motion of a part changes no block of H (residuals and their derivatives depend on relative
// poses alone). Edges whose relative pose has changed too much since are relinearised before a step would suffer, and
// the part of the tree above them is made again (fluid relinearisation: Kaess et al., iSAM2, IJRR 2012). The gradient
// is always exact. Vertices that hang on one edge take no part (`leaf_vertices.h`).
#pragma once

#include <vector>

#include "server/graph/large/clique_tree.h"
#include "server/graph/live/leaf_vertices.h"
#include "server/graph/live/live_state.h"

namespace rigcal::graph {

// The factor of a state's H, made with the first descent that needs it.
struct DeepFactor {
  bool holds = false;  // what follows is of the state; otherwise the next descent begins anew
  CliqueTree tree;     // without the edges of leaves
  LeafVertices leaves;
  std::vector<Se3> linearized_at;  // T_i_j of every constraint as the tree knows it
};

// The newest vertex of the state hangs on its last constraint.
void AddLeaf(DeepFactor& factor, LiveState& state);
// This constraint is about to be erased from the state.
void Drop(std::size_t constraint, const LiveState& state, DeepFactor& factor);

// Poses to the optimum of the state whose last constraint is new, as near as the budget asks. False, with the state in
// between, if the budget does not suffice for a factor, steps lead uphill, or H is not positive definite: then the
// batch decides.
[[nodiscard]] bool DescendWithNewest(const UpdateBudget& budget, DeepFactor& factor, LiveState& state,
                                     UpdateWork& work);
// The same where a constraint has left.
[[nodiscard]] bool DescendWithout(const UpdateBudget& budget, DeepFactor& factor, LiveState& state, UpdateWork& work);

}  // namespace rigcal::graph
