// Updates of deep graphs, by a tree of cliques. Steps are taken with H as it was when its edges were linearised: a
// rigid motion of a part changes no block of H (residuals and their derivatives depend on relative poses alone). Edges
// that were bent since are linearised anew before a step would suffer, and the part of the tree above them is made
// again. The gradient is always exact.
//
// A sensor that hangs on one edge takes no part: it follows the sensor it hangs on, until a second edge reaches it.
#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "server/graph/live/live_solver.h"
#include "server/graph/solve/linearize.h"

namespace rigcal::graph {
namespace {

constexpr double kBent_rad = 0.02, kBent_ratio = 0.04;  // turned, or moved, as a part of its length
constexpr double kLever_ratio = 0.05;                   // of sigma_m / sigma_rad: the least length that counts
constexpr double kBentStrict = 0.1;                     // of these, where steps gain less than they should
constexpr double kTurnMax_rad = 0.5;     // an edge that disagrees by more may lead to another basin: the batch decides
constexpr double kRestRelative = 1e-11;  // of the cost: what may be left to gain
constexpr double kSettledRelative = 1e-9;
constexpr double kShrink = 0.1;              // what a gain must be of the one before, or the factor is too old
constexpr double kRoundingRelative = 1e-12;  // of the cost: a rise by less is no rise
constexpr double kStepLeast = 1e-12;         // m and rad
constexpr int kStepsMax = 12;

// One edge's part of H at a relative pose: U U^T.
CliqueTree::Edge Linearized(const Constraint& constraint, const Se3& T_i_j) {
  const Matrix6d root = constraint.Omega.llt().matrixL();
  const Matrix6d J_j = RightJacobianInverse((constraint.T_j_i * T_i_j).Log());
  const Matrix6d U_j = J_j.transpose() * root;
  return {constraint.i - 1, constraint.j - 1, -Adjoint(T_i_j.Inverse()).transpose() * U_j, U_j};
}

}  // namespace

Se3 LiveSolver::RelativePose(const Constraint& constraint) const {
  return T_ref_[static_cast<std::size_t>(constraint.i)].Inverse() * T_ref_[static_cast<std::size_t>(constraint.j)];
}

// The newest vertex hangs on the newest edge.
void LiveSolver::GrowLeaf() {
  if (!tree_holds_) return;
  hangs_on_.push_back(static_cast<int>(problem_->constraints.size()) - 1);
  linearized_at_.emplace_back();
  equations_.g.conservativeResizeLike(Eigen::VectorXd::Zero(6 * problem_->free_count()));
}

// Where a vertex that hangs on an edge stands.
Se3 LiveSolver::Hanging(int vertex, const Poses& T_ref) const {
  const Constraint& constraint =
      problem_->constraints[static_cast<std::size_t>(hangs_on_[static_cast<std::size_t>(vertex)])];
  if (constraint.j == vertex) return (T_ref[static_cast<std::size_t>(constraint.i)] * constraint.T_i_j).Normalized();
  return (T_ref[static_cast<std::size_t>(constraint.j)] * constraint.T_j_i).Normalized();
}

// The vertex, and all it hangs on, take part from now on.
void LiveSolver::TakePart(int vertex) {
  for (int edge = 0; (edge = hangs_on_[static_cast<std::size_t>(vertex)]) >= 0;) {
    hangs_on_[static_cast<std::size_t>(vertex)] = -1;
    TakeEdge(static_cast<std::size_t>(edge));
    const Constraint& constraint = problem_->constraints[static_cast<std::size_t>(edge)];
    vertex = constraint.i == vertex ? constraint.j : constraint.i;
  }
}

void LiveSolver::TakeEdge(std::size_t edge) {
  const Constraint& constraint = problem_->constraints[edge];
  linearized_at_[edge] = RelativePose(constraint);
  tree_.Take(edge, Linearized(constraint, linearized_at_[edge]));
}

void LiveSolver::Count(UpdateWork& work) {
  work.products += tree_.products() - products_counted_;
  work.columns_factored += tree_.columns() - columns_counted_;
  products_counted_ = tree_.products();
  columns_counted_ = tree_.columns();
}

bool LiveSolver::RenewDeep(UpdateWork& work) {
  for (const int edge : tree_.Open()) {
    const auto k = static_cast<std::size_t>(edge);
    linearized_at_[k] = RelativePose(problem_->constraints[k]);
    tree_.Replace(k, Linearized(problem_->constraints[k], linearized_at_[k]));
    ++work.edges_evaluated;
  }
  const Constraint& newest = problem_->constraints.back();
  tree_holds_ = tree_.Renew(newest.i - 1, newest.j - 1, budget_.products_max);
  Count(work);
  return tree_holds_;
}

// Vertices with one edge, or one beside those that hang on them, if it leads to a vertex that came before: so that
// poses can follow in the order of vertices. (An edge that left may leave a later one behind; such a vertex takes
// part.)
void LiveSolver::FindHanging() {
  std::vector<int> count(T_ref_.size(), 0), sum(T_ref_.size(), 0);  // edges; of their numbers
  const auto add = [&](int edge, int sign) {
    const Constraint& constraint = problem_->constraints[static_cast<std::size_t>(edge)];
    for (const int vertex : {constraint.i, constraint.j})
      count[static_cast<std::size_t>(vertex)] += sign, sum[static_cast<std::size_t>(vertex)] += sign * edge;
  };
  for (std::size_t k = 0; k < problem_->constraints.size(); ++k) add(static_cast<int>(k), 1);
  hangs_on_.assign(T_ref_.size(), -1);
  for (std::size_t v = T_ref_.size(); v-- > 1;) {
    if (count[v] != 1) continue;
    const Constraint& only = problem_->constraints[static_cast<std::size_t>(sum[v])];
    if (std::min(only.i, only.j) == static_cast<int>(v)) continue;
    hangs_on_[v] = sum[v];
    add(sum[v], -1);
  }
}

// Everything anew.
bool LiveSolver::BeginDeep(UpdateWork& work) {
  tree_.Clear();
  products_counted_ = 0.0;
  columns_counted_ = 0;
  linearized_at_.assign(problem_->constraints.size(), Se3());
  FindHanging();
  for (std::size_t k = 0; k < problem_->constraints.size(); ++k) {
    if (!Hangs(k)) TakeEdge(k);
  }
  for (std::size_t v = 1; v < T_ref_.size(); ++v)
    if (hangs_on_[v] >= 0) T_ref_[v] = Hanging(static_cast<int>(v), T_ref_);
  LinearizeGradient(*problem_, T_ref_, equations_);
  work.edges_evaluated += static_cast<int>(problem_->constraints.size());
  return RenewDeep(work);
}

// An edge that disagrees by much may hold the poses in one basin, or pull them into another.
bool LiveSolver::MayLeaveBasin(const Constraint& constraint) const {
  return Residual(constraint, T_ref_).tail<3>().norm() > kTurnMax_rad;
}

bool LiveSolver::Hangs(std::size_t edge) const {
  const Constraint& constraint = problem_->constraints[edge];
  return hangs_on_[static_cast<std::size_t>(std::max(constraint.i, constraint.j))] == static_cast<int>(edge);
}

// Gradient and cost at the poses at hand, and the factor, after edges of the tree have changed.
bool LiveSolver::RenewGradientDeep(UpdateWork& work) {
  if (!tree_holds_) return BeginDeep(work);
  LinearizeGradient(*problem_, T_ref_, equations_);
  work.edges_evaluated += static_cast<int>(problem_->constraints.size());
  tree_.TouchAll();
  return RenewDeep(work);
}

// Takes the edge into the gradient, the cost and the factor.
bool LiveSolver::JoinDeep(const Constraint& added, UpdateWork& work) {
  if (MayLeaveBasin(added)) return false;
  problem_->constraints.push_back(added);
  if (!tree_holds_) return BeginDeep(work);
  linearized_at_.emplace_back();
  TakePart(added.i);
  TakePart(added.j);
  TakeEdge(problem_->constraints.size() - 1);
  const EdgeJacobian jacobian = JacobianOf(added, T_ref_);
  AddToGradient(added, jacobian, jacobian.e, equations_.g);
  equations_.cost += jacobian.e.dot(added.Omega * jacobian.e);
  return RenewDeep(work);
}

// Frames in one place have no length of their own: there the length counts at which a turn is as uncertain as a move.
bool LiveSolver::IsBent(std::size_t edge, double part) const {
  const Constraint& constraint = problem_->constraints[edge];
  const Se3& before = linearized_at_[edge];
  const Se3 change = before.Inverse() * RelativePose(constraint);
  const Vector6d information = constraint.Omega.diagonal();
  const double lever_m = std::sqrt(information.tail<3>().sum() / information.head<3>().sum());
  const double length_m = std::max(before.p_m.norm(), kLever_ratio * lever_m);
  return 2.0 * change.q.vec().norm() > part * kBent_rad || change.p_m.norm() > part * kBent_ratio * length_m;
}

// Linearises anew the edges that were bent by more than this part of what is allowed since the factor learnt them.
// False if there is none, or no factor left.
bool LiveSolver::Straighten(double part, UpdateWork& work) {
  bool any = false;
  for (std::size_t k = 0; k < linearized_at_.size(); ++k) {
    if (Hangs(k) || !IsBent(k, part)) continue;
    tree_.Change(k);
    any = true;
  }
  return any && RenewDeep(work);
}

// False, and nothing has happened, if the step leads uphill.
bool LiveSolver::StepDeep(UpdateWork& work) {
  const double cost_before = equations_.cost;
  g_before_ = equations_.g;
  trial_.resize(T_ref_.size());
  trial_[0] = T_ref_[0];
  for (std::size_t v = 1; v < T_ref_.size(); ++v) {
    const Eigen::Index row = 6 * (static_cast<Eigen::Index>(v) - 1);
    trial_[v] = hangs_on_[v] >= 0 ? Hanging(static_cast<int>(v), trial_)
                                  : (T_ref_[v] * Se3::Exp(step_.segment<6>(row))).Normalized();
  }
  LinearizeGradient(*problem_, trial_, equations_);
  ++work.iterations;
  work.edges_evaluated += static_cast<int>(problem_->constraints.size());
  if (equations_.cost <= (1.0 + kRoundingRelative) * cost_before) {
    std::swap(T_ref_, trial_);
    tree_.TouchAll();
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
  return JoinDeep(added, work) && DescendDeep(work);
}

bool LiveSolver::DescendDeep(UpdateWork& work) {
  const double enough = large() ? budget_.rest_ratio : kRestRelative;
  bool straight = true;  // as far as straightening makes it
  double part = 1.0;     // 0: H is that of these poses, no other factor would do better
  for (double gain_before = std::numeric_limits<double>::infinity();;) {
    const double gain = tree_.Reduce(equations_.g), rest = enough * equations_.cost;
    Count(work);
    if (!std::isfinite(gain)) return false;
    const double rest_ratio = equations_.cost > 0.0 ? gain / equations_.cost : 0.0;
    const bool spent = work.iterations >= kStepsMax || work.products >= budget_.products_max;
    if (rest_ratio <= enough || (spent && large())) return LeaveRest(rest_ratio, work), true;
    if (spent) return false;
    if (!std::exchange(straight, true) && Straighten(1.0, work)) continue;
    if (!tree_holds_) return false;
    const bool slow = gain > kShrink * gain_before && gain / gain_before * gain > rest;
    if (!slow || part == 0.0) {
      step_.resize(equations_.g.size());
      tree_.Finish(step_);
      Count(work);
      step_ = -step_;
      if (step_.cwiseAbs().maxCoeff() <= kStepLeast) return LeaveRest(0.0, work), true;
      if (StepDeep(work)) {
        gain_before = gain;
        straight = false;
        part = 1.0;
        continue;
      }
      if (part == 0.0) return false;
    }
    part = part == 1.0 ? kBentStrict : 0.0;
    Straighten(part, work);
    if (!tree_holds_) return false;
  }
}

}  // namespace rigcal::graph
