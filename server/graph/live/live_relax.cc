#include <algorithm>
#include <cmath>
#include <limits>

#include "server/graph/large/dense_cholesky.h"
#include "server/graph/live/live_solver.h"
#include "server/graph/solve/conjugate_gradients.h"

namespace rigcal::graph {
namespace {

constexpr double kStepMax = 0.05;        // m and rad: a larger step may leave the basin, so the batch decides
constexpr double kRestRelative = 1e-11;  // of the cost: what may be left to gain
constexpr double kRestLarge = 0.1;       // of what the budget of a large graph leaves: gains are estimates
constexpr double kShrink = 0.1;          // what a gain must be of the one before
constexpr double kShrinkLeast = 0.01;    // one good step does not promise that the next shrinks as well
constexpr int kStepsMax = 12, kStepsFresh = 5;

// Of block columns first .. count - 1 of a dense factor; of a solve with it.
double ProductsOfDense(int first, int count) {
  double products = 0.0;
  for (int c = first; c < count; ++c) products += (c + 1.0) * (count - c);
  return products;
}
double ProductsOfDenseSolve(int count) { return count * (count + 1.0) / 6.0; }

}  // namespace

bool LiveSolver::FactorNow(UpdateWork& work) {
  const int count = problem_->free_count();
  if (stale_) Linearize(*problem_, T_ref_, equations_);
  if (stale_ || count != factored_count_) dirty_from_ = 0;
  stale_ = false;
  work.columns_factored += count - dirty_from_;
  const int first = std::exchange(dirty_from_, count);
  if (count > kBlocksDenseMax) {
    if (count != factored_count_) solver_ = std::make_unique<ConjugateGradients>(problem_->pattern);
    factored_count_ = count;
    work.products += count;
    return solver_->Factor(equations_.H, 0.0);
  }
  if (count != factored_count_) solver_ = std::make_unique<DenseCholesky<6>>(problem_->pattern);
  factored_count_ = count;
  work.products += ProductsOfDense(first, count);
  return static_cast<DenseCholesky<6>&>(*solver_).FactorFrom(first, equations_.H, 0.0);
}

// x <- H^-1 x.
void LiveSolver::SolveStep(Eigen::VectorXd& x, UpdateWork& work) {
  if (factored_count_ <= kBlocksDenseMax) {
    work.products += ProductsOfDenseSolve(factored_count_);
    return solver_->SolveInPlace(x);
  }
  const auto& gradients = static_cast<const ConjugateGradients&>(*solver_);
  const double before = gradients.products();
  solver_->SolveInPlace(x);
  work.products += gradients.products() - before;
}

bool LiveSolver::Relax(const Constraint& added, UpdateWork& work) {
  // The gradient before the edge: none at an optimum.
  if (large())
    equations_.g.conservativeResizeLike(Eigen::VectorXd::Zero(6 * problem_->free_count()));
  else
    equations_.g.setZero(6 * problem_->free_count());
  LinearizeEdge(added, T_ref_, equations_.H, &equations_.g);
  problem_->constraints.push_back(added);
  dirty_from_ = std::min(dirty_from_, std::max(std::min(added.i, added.j) - 1, 0));
  return FactorNow(work) && Descend(work);
}

// From the poses at hand, whose gradient is there, with the factor at hand.
bool LiveSolver::Descend(UpdateWork& work) {
  const double enough = large() ? kRestLarge * budget_.rest_ratio : kRestRelative;
  secants_.Clear();
  double gain_before = std::numeric_limits<double>::infinity();
  for (work.iterations = 1; work.iterations <= kStepsMax; ++work.iterations) {
    step_ = -equations_.g;
    secants_.Apply(step_, [this, &work](Eigen::VectorXd& x) { SolveStep(x, work); });
    const double gain = -step_.dot(equations_.g);
    if (!std::isfinite(gain) || step_.cwiseAbs().maxCoeff() > kStepMax) return false;
    Retract(T_ref_, step_, trial_);
    std::swap(T_ref_, trial_);
    const double ratio = gain / gain_before;
    if (work.iterations > 2 && ratio > kShrink && gain > enough * equations_.cost) return false;
    if (work.iterations > 1 && std::clamp(ratio, kShrinkLeast, kShrink) * gain <= enough * equations_.cost) break;
    gain_before = gain;
    g_before_ = equations_.g;
    LinearizeGradient(*problem_, T_ref_, equations_);
    work.edges_evaluated += static_cast<int>(problem_->constraints.size());
    if (work.iterations > 1) secants_.Remember(step_, equations_.g - g_before_);
  }
  stale_ = work.iterations > kStepsFresh;
  if (problem_->vertex_count >= budget_.sensors_exact_max) LinearizeGradient(*problem_, T_ref_, equations_);
  LeaveRest(large() ? enough : 0.0, work);
  return work.iterations <= kStepsMax;
}

// H loses what an edge that leaves brought, and the descent goes on from the poses at hand: the same cliques change as
// when the edge came.
UpdateWork LiveSolver::Remove(const EdgeId& edge) {
  const auto rest = std::remove_if(graph_.edges.begin(), graph_.edges.end(),
                                   [&edge](const GraphEdge& candidate) { return candidate.id == edge; });
  const auto count = std::distance(rest, graph_.edges.end());
  if (count == 0) return {};
  graph_.edges.erase(rest, graph_.edges.end());
  if (!fast_ || count > 1) return Rebuild();
  const auto found = std::find(id_of_constraint_.begin(), id_of_constraint_.end(), edge);
  if (found == id_of_constraint_.end()) return {};  // it took no part
  const auto k = static_cast<std::size_t>(std::distance(id_of_constraint_.begin(), found));
  if (!ConnectedWithout(k) || MayLeaveBasin(problem_->constraints[k])) return Rebuild();
  Forget(k);
  stale_ = true;
  UpdateWork work;
  // H is made anew where it holds what is no longer so: in a tree of cliques, above what changed; else everywhere.
  const bool relaxed =
      deep() ? RenewGradientDeep(work) && DescendDeep(work) : FactorNow(work) && Descend(work);
  return relaxed ? work : Rebuild(work);
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

}  // namespace rigcal::graph
