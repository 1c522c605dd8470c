// Edges that leave, or weigh something else from now on. H loses what they brought, and the descent goes on from the
// poses at hand: the same cliques change as when the edge came.
#include <algorithm>

#include "server/graph/live_solver.h"
#include "server/graph/union_find.h"

namespace rigcal::graph {

UpdateWork LiveSolver::Remove(const EdgeId& edge) {
  const auto rest = std::remove_if(graph_.edges.begin(), graph_.edges.end(),
                                   [&edge](const GraphEdge& candidate) { return candidate.id == edge; });
  const auto count = std::distance(rest, graph_.edges.end());
  if (count == 0) return {};
  graph_.edges.erase(rest, graph_.edges.end());
  if (!fast_ || count > 1) return Rebuild();
  const std::optional<std::size_t> k = ConstraintOf(edge);
  if (!k) return {};  // it took no part
  if (!ConnectedWithout(*k) || MayLeaveBasin(problem_->constraints[*k])) return Rebuild();
  Forget(*k);
  UpdateWork work;
  return RelaxAnew(work) ? work : Rebuild(work);
}

UpdateWork LiveSolver::Reweight(const EdgeId& edge, const Matrix6d& Omega, int rank) {
  Constraint changed;
  int count = 0;
  bool usable = true;
  for (GraphEdge& candidate : graph_.edges) {
    if (candidate.id != edge) continue;
    candidate.Omega = Omega;
    candidate.rank = rank;
    usable = FillConstraint(candidate, 0, changed).empty();
    ++count;
  }
  if (count == 0) return {};
  const std::optional<std::size_t> k = ConstraintOf(edge);
  if (!fast_ || count > 1 || !usable || changed.rank < 6 || !k) return Rebuild();
  Constraint& constraint = problem_->constraints[*k];
  changed.i = constraint.i, changed.j = constraint.j, changed.slot = constraint.slot;
  constraint = changed;
  if (MayLeaveBasin(constraint)) return Rebuild();
  if (tree_holds_ && Hangs(*k)) return {};  // its residual is zero whatever it weighs
  if (tree_holds_) tree_.Change(*k);
  UpdateWork work;
  return RelaxAnew(work) ? work : Rebuild(work);
}

std::optional<std::size_t> LiveSolver::ConstraintOf(const EdgeId& edge) const {
  const auto found = std::find(id_of_constraint_.begin(), id_of_constraint_.end(), edge);
  if (found == id_of_constraint_.end()) return std::nullopt;
  return static_cast<std::size_t>(std::distance(id_of_constraint_.begin(), found));
}

bool LiveSolver::ConnectedWithout(std::size_t edge) const {
  UnionFind sets(static_cast<std::size_t>(problem_->vertex_count));
  int parts = problem_->vertex_count;
  for (std::size_t k = 0; k < problem_->constraints.size(); ++k)
    if (k != edge && sets.Join(problem_->constraints[k].i, problem_->constraints[k].j)) --parts;
  return parts == 1;
}

// The last constraint takes the place of this one.
void LiveSolver::Forget(std::size_t edge) {
  std::vector<Constraint>& constraints = problem_->constraints;
  const std::size_t last = constraints.size() - 1;
  if (tree_holds_) {
    tree_.Drop(edge, last);
    for (const int vertex : {constraints[last].i, constraints[last].j})
      if (int& at = hangs_on_[static_cast<std::size_t>(vertex)]; at == static_cast<int>(last))
        at = static_cast<int>(edge);
    linearized_at_[edge] = linearized_at_[last];
    linearized_at_.pop_back();
  }
  constraints[edge] = constraints[last];
  id_of_constraint_[edge] = id_of_constraint_[last];
  constraints.pop_back();
  id_of_constraint_.pop_back();
}

// With H made anew where it holds what is no longer so: in a tree of cliques, above what changed; else everywhere.
bool LiveSolver::RelaxAnew(UpdateWork& work) {
  stale_ = true;
  if (!deep()) return FactorNow(work) && Descend(work);
  return RenewGradientDeep(work) && DescendDeep(work);
}

}  // namespace rigcal::graph
