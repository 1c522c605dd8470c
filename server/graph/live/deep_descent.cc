#include "server/graph/live/deep_descent.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace rigcal::graph {
namespace {

constexpr double kTurned_rad = 0.02, kMoved_ratio = 0.04;  // since it was linearised; moved: as a part of its length
constexpr double kLever_ratio = 0.05;                      // of sigma_m / sigma_rad: the least length that counts
constexpr double kStrict = 0.1;                            // of these, where steps gain less than they should
constexpr double kRestRelative = 1e-11;                    // of the cost: what may be left to gain
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

// Whether an edge has turned or moved, since it was linearised at T_i_j_before, by more than this part of what is
// allowed. Frames in one place have no length of their own: there the length counts at which a turn is as uncertain as
// a move.
bool NeedsRelinearization(const Constraint& constraint, const Se3& T_i_j_before, const Se3& T_i_j, double part) {
  const Se3 change = T_i_j_before.Inverse() * T_i_j;
  const Vector6d information = constraint.Omega.diagonal();
  const double lever_m = std::sqrt(information.tail<3>().sum() / information.head<3>().sum());
  const double length_m = std::max(T_i_j_before.p_m.norm(), kLever_ratio * lever_m);
  return 2.0 * change.q.vec().norm() > part * kTurned_rad || change.p_m.norm() > part * kMoved_ratio * length_m;
}

// One update. Its functions that renew the factor are false if there is none any more.
class Descent {
 public:
  Descent(const UpdateBudget& budget, DeepFactor& factor, LiveState& state, UpdateWork& work)
      : budget_(budget), factor_(factor), state_(state), work_(work) {}

  bool Begin();
  bool TakeNewest();
  bool Refresh();
  bool Run();

 private:
  void TakeEdge(std::size_t edge);
  bool Renew();
  bool Relinearize(double part);
  double Gain();
  bool Step();
  template <typename OnTree>
  auto Counted(const OnTree& on_tree);
  [[nodiscard]] const std::vector<Constraint>& constraints() const { return state_.problem.constraints; }

  const UpdateBudget& budget_;
  DeepFactor& factor_;
  LiveState& state_;
  UpdateWork& work_;
};

// What the tree does counts as work.
template <typename OnTree>
auto Descent::Counted(const OnTree& on_tree) {
  const double products = factor_.tree.products();
  const int columns = factor_.tree.columns();
  const auto result = on_tree(factor_.tree);
  work_.products += factor_.tree.products() - products;
  work_.columns_factored += factor_.tree.columns() - columns;
  return result;
}

void Descent::TakeEdge(std::size_t edge) {
  factor_.linearized_at[edge] = PoseAcross(constraints()[edge], state_.T_ref);
  factor_.tree.Take(edge, Linearized(constraints()[edge], factor_.linearized_at[edge]));
}

bool Descent::Renew() {
  for (const int edge : factor_.tree.Open()) {
    const auto k = static_cast<std::size_t>(edge);
    factor_.linearized_at[k] = PoseAcross(constraints()[k], state_.T_ref);
    factor_.tree.Replace(k, Linearized(constraints()[k], factor_.linearized_at[k]));
  }
  const Constraint& newest = constraints().back();
  factor_.holds =
      Counted([&](CliqueTree& tree) { return tree.Renew(newest.i - 1, newest.j - 1, budget_.products_max); });
  return factor_.holds;
}

// Everything anew.
bool Descent::Begin() {
  factor_.tree.Clear();
  factor_.linearized_at.assign(constraints().size(), Se3());
  factor_.leaves = LeafVertices(constraints(), state_.problem.vertex_count);
  for (std::size_t k = 0; k < constraints().size(); ++k) {
    if (!factor_.leaves.IsHeldBy(k, constraints()[k])) TakeEdge(k);
  }
  for (int v = 1; v < state_.problem.vertex_count; ++v)
    if (factor_.leaves.IsLeaf(v))
      state_.T_ref[static_cast<std::size_t>(v)] = factor_.leaves.PoseOf(v, constraints(), state_.T_ref);
  LinearizeGradient(state_.problem, state_.T_ref, state_.equations);
  return Renew();
}

// The last constraint into the gradient, the cost and the factor.
bool Descent::TakeNewest() {
  if (!factor_.holds) return Begin();
  const Constraint& newest = constraints().back();
  factor_.linearized_at.emplace_back();
  for (const int vertex : {newest.i, newest.j})
    for (const int edge : factor_.leaves.Activate(vertex, constraints())) TakeEdge(static_cast<std::size_t>(edge));
  TakeEdge(constraints().size() - 1);
  const EdgeJacobian jacobian = JacobianOf(newest, state_.T_ref);
  AddToGradient(newest, jacobian, jacobian.e, state_.equations.g);
  state_.equations.cost += jacobian.e.dot(newest.Omega * jacobian.e);
  return Renew();
}

// Gradient and cost at the poses at hand, and the factor, after edges of the tree have changed.
bool Descent::Refresh() {
  if (!factor_.holds) return Begin();
  LinearizeGradient(state_.problem, state_.T_ref, state_.equations);
  factor_.tree.TouchAll();
  return Renew();
}

// The edges that have changed by more than this part of what is allowed. False also if there is none.
bool Descent::Relinearize(double part) {
  bool any = false;
  for (std::size_t k = 0; k < factor_.linearized_at.size(); ++k) {
    const Constraint& constraint = constraints()[k];
    if (factor_.leaves.IsHeldBy(k, constraint)) continue;
    if (!NeedsRelinearization(constraint, factor_.linearized_at[k], PoseAcross(constraint, state_.T_ref), part))
      continue;
    factor_.tree.Change(k);
    any = true;
  }
  return any && Renew();
}

// Of the cost by the step that the factor gives: g^T H^-1 g.
double Descent::Gain() {
  return Counted([this](CliqueTree& tree) { return tree.Reduce(state_.equations.g); });
}

// False, and nothing has happened, if the step leads uphill.
bool Descent::Step() {
  auto& [secants, step, g_before, trial] = state_.workspace;
  NormalEquations& equations = state_.equations;
  const double cost_before = equations.cost;
  g_before = equations.g;
  trial.resize(state_.T_ref.size());
  trial[0] = state_.T_ref[0];
  for (int v = 1; v < state_.problem.vertex_count; ++v) {
    const auto at = static_cast<std::size_t>(v);
    trial[at] = factor_.leaves.IsLeaf(v) ? factor_.leaves.PoseOf(v, constraints(), trial)
                                         : (state_.T_ref[at] * Se3::Exp(step.segment<6>(6 * (v - 1)))).Normalized();
  }
  LinearizeGradient(state_.problem, trial, equations);
  ++work_.iterations;
  if (equations.cost <= (1.0 + kRoundingRelative) * cost_before) {
    std::swap(state_.T_ref, trial);
    factor_.tree.TouchAll();
    return true;
  }
  equations.g = g_before;
  equations.cost = cost_before;
  return false;
}

bool Descent::Run() {
  const bool large = budget_.IsLarge(state_.problem);
  const double enough = large ? budget_.rest_ratio : kRestRelative;
  Eigen::VectorXd& step = state_.workspace.step;
  bool straight = true;  // as far as relinearising makes it
  double part = 1.0;     // 0: H is that of these poses, no other factor would do better
  for (double gain_before = std::numeric_limits<double>::infinity();;) {
    const double gain = Gain(), rest = enough * state_.equations.cost;
    if (!std::isfinite(gain)) return false;
    work_.rest_ratio = state_.equations.cost > 0.0 ? gain / state_.equations.cost : 0.0;
    const bool spent = work_.iterations >= kStepsMax || work_.products >= budget_.products_max;
    if (work_.rest_ratio <= enough || (spent && large)) return true;
    if (spent) return false;
    if (!std::exchange(straight, true) && Relinearize(1.0)) continue;
    if (!factor_.holds) return false;
    const bool slow = gain > kShrink * gain_before && gain / gain_before * gain > rest;
    if (!slow || part == 0.0) {
      step.resize(state_.equations.g.size());
      Counted([&step](CliqueTree& tree) { return tree.Finish(step), true; });
      step = -step;
      if (step.cwiseAbs().maxCoeff() <= kStepLeast) {
        work_.rest_ratio = 0.0;
        return true;
      }
      if (Step()) {
        gain_before = gain;
        straight = false;
        part = 1.0;
        continue;
      }
      if (part == 0.0) return false;
    }
    part = part == 1.0 ? kStrict : 0.0;
    Relinearize(part);
    if (!factor_.holds) return false;
  }
}

}  // namespace

void AddLeaf(DeepFactor& factor, LiveState& state) {
  if (!factor.holds) return;
  factor.leaves.Add(state.problem.constraints.size() - 1);
  factor.linearized_at.emplace_back();
  state.equations.g.conservativeResizeLike(Eigen::VectorXd::Zero(6 * state.problem.free_count()));
}

void Drop(std::size_t constraint, const LiveState& state, DeepFactor& factor) {
  if (!factor.holds) return;
  const std::size_t last = state.problem.constraints.size() - 1;
  factor.tree.Drop(constraint, last);
  factor.leaves.Renumber(state.problem.constraints[last], last, constraint);
  factor.linearized_at[constraint] = factor.linearized_at[last];
  factor.linearized_at.pop_back();
}

bool DescendWithNewest(const UpdateBudget& budget, DeepFactor& factor, LiveState& state, UpdateWork& work) {
  Descent descent(budget, factor, state, work);
  return descent.TakeNewest() && descent.Run();
}

bool DescendWithout(const UpdateBudget& budget, DeepFactor& factor, LiveState& state, UpdateWork& work) {
  Descent descent(budget, factor, state, work);
  return descent.Refresh() && descent.Run();
}

}  // namespace rigcal::graph
