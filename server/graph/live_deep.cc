// Updates of deep graphs, by a factor that grows. Steps are taken with H as it was when the factor was made: a rigid
// motion of a part changes no block of H (residuals and their derivatives depend on relative poses alone). Edges that
// were bent since are linearised anew, one by one, before a step would suffer. The gradient is always exact.
#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "server/graph/edge_jacobian.h"
#include "server/graph/live_solver.h"

namespace rigcal::graph {
namespace {

constexpr int kCorrectionsMax = 64;  // then a new factor is cheaper than the corrections of the old one
constexpr double kBent_rad = 0.02, kBent_ratio = 0.04;  // turned, or moved, as a part of its length
constexpr int kBentMax = 5;                             // more at once: a new factor is cheaper
constexpr double kTurnMax_rad = 0.5;     // an edge that disagrees by more may lead to another basin: the batch decides
constexpr double kRestRelative = 1e-11;  // of the cost: what may be left to gain
constexpr double kSettledRelative = 1e-9;
constexpr double kShrink = 0.1;              // what a gain must be of the one before, or the factor is too old
constexpr double kRoundingRelative = 1e-12;  // of the cost: a rise by less is no rise
constexpr double kStepLeast = 1e-12;         // m and rad
constexpr int kStepsMax = 12;

}  // namespace

Se3 LiveSolver::RelativePose(const Constraint& constraint) const {
  return T_ref_[static_cast<std::size_t>(constraint.i)].Inverse() * T_ref_[static_cast<std::size_t>(constraint.j)];
}

void LiveSolver::GrowLeaf(const Constraint& constraint) {
  if (!growing_holds_) return;
  const EdgeJacobian jacobian = JacobianOf(constraint, T_ref_);
  const bool leaf_is_j = constraint.j > constraint.i;
  const Matrix6d& J_leaf = leaf_is_j ? jacobian.J_j : jacobian.J_i;
  const Matrix6d& J_parent = leaf_is_j ? jacobian.J_i : jacobian.J_j;
  const Matrix6d weighted = constraint.Omega * J_leaf;
  linearized_at_.push_back(RelativePose(constraint));
  growing_holds_ = growing_.AddLeaf(std::min(constraint.i, constraint.j) - 1, J_leaf.transpose() * weighted,
                                    J_parent.transpose() * weighted);
}

bool LiveSolver::RenewDeep(UpdateWork& work) {
  Linearize(*problem_, T_ref_, equations_);
  linearized_at_.clear();
  for (const Constraint& constraint : problem_->constraints) linearized_at_.push_back(RelativePose(constraint));
  growing_holds_ = growing_.Renew(problem_->pattern, equations_.H, budget_.products_max);
  work.edges_evaluated += static_cast<int>(problem_->constraints.size());
  work.columns_factored += problem_->free_count();
  work.products += growing_.products_of_factor();
  return growing_holds_;
}

// What one edge adds to H at a relative pose: U U^T with these rows.
struct LiveSolver::EdgeRoot {
  Matrix6d U_i, U_j;
};

LiveSolver::EdgeRoot LiveSolver::RootAt(const Constraint& constraint, const Se3& T_i_j) {
  const Matrix6d root = constraint.Omega.llt().matrixL();
  const Matrix6d J_j = RightJacobianInverse((constraint.T_j_i * T_i_j).Log());
  const Matrix6d U_j = J_j.transpose() * root;
  return {-Adjoint(T_i_j.Inverse()).transpose() * U_j, U_j};
}

bool LiveSolver::Correct(double sign, const Constraint& constraint, const Se3& T_i_j, UpdateWork& work) {
  const EdgeRoot root = RootAt(constraint, T_i_j);
  const int columns = growing_.AddEdge(sign, constraint.i - 1, root.U_i, constraint.j - 1, root.U_j);
  work.columns_factored += std::max(columns, 0);
  return columns >= 0;
}

// Takes the edge into the gradient, the cost and the factor.
bool LiveSolver::JoinDeep(const Constraint& added, UpdateWork& work) {
  const EdgeJacobian jacobian = JacobianOf(added, T_ref_);
  if (jacobian.e.tail<3>().norm() > kTurnMax_rad) return false;
  problem_->constraints.push_back(added);
  if (!growing_holds_ || growing_.corrections() >= kCorrectionsMax) return RenewDeep(work);
  equations_.g.conservativeResizeLike(Eigen::VectorXd::Zero(6 * problem_->free_count()));
  AddToGradient(added, jacobian, jacobian.e, equations_.g);
  equations_.cost += jacobian.e.dot(added.Omega * jacobian.e);
  linearized_at_.push_back(RelativePose(added));
  return Correct(1.0, added, linearized_at_.back(), work) || RenewDeep(work);
}

// Linearises anew the edges that were bent since the factor learnt them. False if there is none, or no factor left.
bool LiveSolver::Straighten(UpdateWork& work) {
  std::vector<std::size_t> bent;
  for (std::size_t k = 0; k < linearized_at_.size(); ++k) {
    const Vector6d change = (linearized_at_[k].Inverse() * RelativePose(problem_->constraints[k])).Log();
    if (change.tail<3>().norm() > kBent_rad || change.head<3>().norm() > kBent_ratio * linearized_at_[k].p_m.norm())
      bent.push_back(k);
  }
  if (bent.empty()) return false;
  if (static_cast<int>(bent.size()) > kBentMax || growing_.corrections() + 2 * kBentMax > kCorrectionsMax)
    return RenewDeep(work);
  for (const std::size_t k : bent) {
    const Constraint& constraint = problem_->constraints[k];
    const Se3 before = std::exchange(linearized_at_[k], RelativePose(constraint));
    if (!Correct(1.0, constraint, linearized_at_[k], work) || !Correct(-1.0, constraint, before, work))
      return RenewDeep(work);
  }
  return true;
}

// False, and nothing has happened, if the step leads uphill.
bool LiveSolver::StepDeep(UpdateWork& work) {
  const double cost_before = equations_.cost;
  g_before_ = equations_.g;
  Retract(T_ref_, step_, trial_);
  LinearizeGradient(*problem_, trial_, equations_);
  ++work.iterations;
  work.edges_evaluated += static_cast<int>(problem_->constraints.size());
  if (equations_.cost <= (1.0 + kRoundingRelative) * cost_before) {
    std::swap(T_ref_, trial_);
    return true;
  }
  equations_.g = g_before_;
  equations_.cost = cost_before;
  return false;
}

void LiveSolver::LeaveRest(double rest_ratio, UpdateWork& work) {
  work.rest_ratio = rest_ratio;
  settled_ = rest_ratio <= kSettledRelative;
}

bool LiveSolver::RelaxDeep(const Constraint& added, UpdateWork& work) {
  stale_ = true;
  if (!JoinDeep(added, work)) return false;
  const double enough = large() ? budget_.rest_ratio : kRestRelative;
  bool fresh = growing_.corrections() == 0;  // H is that of these poses: no other factor would do better
  bool straight = true;                      // as far as straightening makes it
  for (double gain_before = std::numeric_limits<double>::infinity();;) {
    step_ = -equations_.g;
    const double gain = growing_.Reduce(step_);
    work.products += growing_.products_of_solve();
    if (!std::isfinite(gain)) return false;
    const double rest_ratio = equations_.cost > 0.0 ? std::max(gain, 0.0) / equations_.cost : 0.0;
    const bool spent = work.iterations >= kStepsMax || work.products >= budget_.products_max;
    if (rest_ratio <= enough || (spent && large())) return LeaveRest(rest_ratio, work), true;
    if (spent) return false;
    if (!fresh && !straight) {
      straight = true;
      if (Straighten(work)) {
        fresh = growing_.corrections() == 0;
        continue;
      }
      if (!growing_holds_) return false;
    }
    growing_.Finish(step_);
    if (step_.cwiseAbs().maxCoeff() <= kStepLeast) return LeaveRest(0.0, work), true;
    const bool slow = gain > kShrink * gain_before;
    if ((!slow || fresh) && StepDeep(work)) {
      gain_before = gain;
      fresh = straight = false;
      continue;
    }
    if (fresh || !RenewDeep(work)) return false;
    fresh = true;
  }
}

}  // namespace rigcal::graph
