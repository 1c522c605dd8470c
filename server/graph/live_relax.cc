#include <algorithm>
#include <cmath>
#include <limits>

#include "server/graph/conjugate_gradients.h"
#include "server/graph/dense_cholesky.h"
#include "server/graph/live_solver.h"

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

// The gradient before the edge: none at an optimum.
void LiveSolver::BeginGradient() {
  if (large())
    equations_.g.conservativeResizeLike(Eigen::VectorXd::Zero(6 * problem_->free_count()));
  else
    equations_.g.setZero(6 * problem_->free_count());
}

bool LiveSolver::Relax(const Constraint& added, UpdateWork& work) {
  BeginGradient();
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

}  // namespace rigcal::graph
