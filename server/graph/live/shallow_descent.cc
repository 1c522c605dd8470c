#include "server/graph/live/shallow_descent.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "server/graph/large/dense_cholesky.h"
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

// Brings the factor up to the state; false if H is not positive definite.
bool Renew(LiveState& state, ShallowFactor& factor, UpdateWork& work) {
  const int count = state.problem.free_count();
  if (factor.stale) Linearize(state.problem, state.T_ref, state.equations);
  if (factor.stale || count != factor.block_count) factor.dirty_from = 0;
  factor.stale = false;
  work.columns_factored += count - factor.dirty_from;
  const int first = std::exchange(factor.dirty_from, count);
  const bool grown = count != std::exchange(factor.block_count, count);
  if (count > kBlocksDenseMax) {
    if (grown) factor.solver = std::make_unique<ConjugateGradients>(state.problem.pattern);
    work.products += count;
    return factor.solver->Factor(state.equations.H, 0.0);
  }
  if (grown) factor.solver = std::make_unique<DenseCholesky<6>>(state.problem.pattern);
  work.products += ProductsOfDense(first, count);
  return static_cast<DenseCholesky<6>&>(*factor.solver).FactorFrom(first, state.equations.H, 0.0);
}

// x <- H^-1 x.
void Solve(Eigen::VectorXd& x, ShallowFactor& factor, UpdateWork& work) {
  if (factor.block_count <= kBlocksDenseMax) {
    work.products += ProductsOfDenseSolve(factor.block_count);
    return factor.solver->SolveInPlace(x);
  }
  const auto& gradients = static_cast<const ConjugateGradients&>(*factor.solver);
  const double before = gradients.products();
  factor.solver->SolveInPlace(x);
  work.products += gradients.products() - before;
}

// From the poses at hand, whose gradient is there, with the factor at hand.
bool Descend(const UpdateBudget& budget, ShallowFactor& factor, LiveState& state, UpdateWork& work) {
  auto& [secants, step, g_before, trial] = state.workspace;
  NormalEquations& equations = state.equations;
  const bool large = budget.IsLarge(state.problem);
  const double enough = large ? kRestLarge * budget.rest_ratio : kRestRelative;
  secants.Clear();
  double gain_before = std::numeric_limits<double>::infinity();
  for (work.iterations = 1; work.iterations <= kStepsMax; ++work.iterations) {
    step = -equations.g;
    secants.Apply(step, [&factor, &work](Eigen::VectorXd& x) { Solve(x, factor, work); });
    const double gain = -step.dot(equations.g);
    if (!std::isfinite(gain) || step.cwiseAbs().maxCoeff() > kStepMax) return false;
    Retract(state.T_ref, step, trial);
    std::swap(state.T_ref, trial);
    const double ratio = gain / gain_before;
    if (work.iterations > 2 && ratio > kShrink && gain > enough * equations.cost) return false;
    if (work.iterations > 1 && std::clamp(ratio, kShrinkLeast, kShrink) * gain <= enough * equations.cost) break;
    gain_before = gain;
    g_before = equations.g;
    LinearizeGradient(state.problem, state.T_ref, equations);
    if (work.iterations > 1) secants.Remember(step, equations.g - g_before);
  }
  factor.stale = work.iterations > kStepsFresh;
  if (state.problem.vertex_count >= budget.sensors_exact_max) LinearizeGradient(state.problem, state.T_ref, equations);
  work.rest_ratio = large ? enough : 0.0;
  return work.iterations <= kStepsMax;
}

}  // namespace

void TouchColumns(const Constraint& constraint, ShallowFactor& factor) {
  factor.dirty_from = std::min(factor.dirty_from, std::max(std::min(constraint.i, constraint.j) - 1, 0));
}

bool DescendWithNewest(const UpdateBudget& budget, ShallowFactor& factor, LiveState& state, UpdateWork& work) {
  const Constraint& newest = state.problem.constraints.back();
  // The gradient before the edge: none at an optimum.
  if (budget.IsLarge(state.problem))
    state.equations.g.conservativeResizeLike(Eigen::VectorXd::Zero(6 * state.problem.free_count()));
  else
    state.equations.g.setZero(6 * state.problem.free_count());
  LinearizeEdge(newest, state.T_ref, state.equations.H, &state.equations.g);
  TouchColumns(newest, factor);
  return Renew(state, factor, work) && Descend(budget, factor, state, work);
}

bool DescendWithout(const UpdateBudget& budget, ShallowFactor& factor, LiveState& state, UpdateWork& work) {
  return Renew(state, factor, work) && Descend(budget, factor, state, work);
}

}  // namespace rigcal::graph
