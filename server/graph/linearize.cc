#include "server/graph/linearize.h"

#include "server/graph/edge_pair.h"

namespace rigcal::graph {
namespace {

using Eigen::Matrix3d;

// Ad(T_i_j^-1).
UpperBlocks InverseAdjointBlocks(const Se3& T_i_j) {
  const Matrix3d R_j_i = T_i_j.R().transpose();
  return {R_j_i, -R_j_i * Hat(T_i_j.p_m)};
}

// S * [D U; 0 D].
Matrix6d TimesUpper(const Matrix6d& S, const UpperBlocks& A) {
  Matrix6d product;
  product.leftCols<3>().noalias() = S.leftCols<3>() * A.D;
  product.rightCols<3>().noalias() = S.leftCols<3>() * A.U + S.rightCols<3>() * A.D;
  return product;
}

const Se3& PoseOf(const Poses& T_ref, int vertex) { return T_ref[static_cast<std::size_t>(vertex)]; }

// The edge's part of the gradient: J_j = Jr^-1(e), J_i = -J_j Ad(T_j_i). Gives its part of the cost.
double AddForces(const Constraint& constraint, const EdgeState& state, Eigen::VectorXd& g) {
  Vector6d weighted;
  weighted.noalias() = constraint.Omega * state.e;
  const Vector6d g_j = JacobianTransposedTimes(state.e, weighted);
  if (constraint.j > 0) g.segment<6>(6 * (constraint.j - 1)) += g_j;
  if (constraint.i > 0) g.segment<6>(6 * (constraint.i - 1)) -= ForceOnI(state.T_i_j, g_j);
  return state.e.dot(weighted);
}

EdgeState AddGradient(const Constraint& constraint, const Poses& T_ref, NormalEquations& equations) {
  const EdgeState state = EdgeStateAt(constraint, PoseOf(T_ref, constraint.i), PoseOf(T_ref, constraint.j));
  equations.cost += AddForces(constraint, state, equations.g);
  return state;
}

// W = J_j^T Omega J_j serves three blocks.
void AddBlocks(const Constraint& constraint, const Matrix6d& W, const Se3& T_i_j, BlockMatrix<6>& H) {
  const auto i = static_cast<std::size_t>(constraint.i), j = static_cast<std::size_t>(constraint.j);
  if (j > 0) H.diagonal[j - 1] += W;
  if (i == 0) return;
  const UpperBlocks A = InverseAdjointBlocks(T_i_j);
  const Matrix6d WA = TimesUpper(W, A), WA_transposed = WA.transpose();
  H.diagonal[i - 1] += TimesUpper(WA_transposed, A);
  if (constraint.slot < 0) return;
  H.off_diagonal[static_cast<std::size_t>(constraint.slot)] -= j > i ? WA : WA_transposed;
}

void AddHessian(const Constraint& constraint, const EdgeState& state, BlockMatrix<6>& H) {
  const UpperBlocks J_j = JacobianOf(state.e);
  const Matrix6d half = TimesUpper(constraint.Omega, J_j).transpose();
  AddBlocks(constraint, TimesUpper(half, J_j), state.T_i_j, H);
}

void AddForces(const Constraint& constraint, const Vector6d& g_i, const Vector6d& g_j, Eigen::VectorXd& g) {
  if (constraint.j > 0) g.segment<6>(6 * (constraint.j - 1)) += g_j;
  if (constraint.i > 0) g.segment<6>(6 * (constraint.i - 1)) -= g_i;
}

// False if one of the two needs the closed forms.
bool AddGradients(const Constraint& a, const Constraint& b, const Poses& T_ref, NormalEquations& equations) {
  pair::State state;
  if (!pair::StateAt(a, b, T_ref, state)) return false;
  const pair::Twist weighted = pair::Weighted(a.Omega, b.Omega, state.e);
  const pair::Double2 cost = pair::Dot(state.e.linear, weighted.linear) + pair::Dot(state.e.angular, weighted.angular);
  equations.cost += cost[0] + cost[1];
  const pair::Twist g_j = pair::ForceOnJ(state.e, weighted), g_i = pair::ForceOnI(state, g_j);
  AddForces(a, g_i.Lane(0), g_j.Lane(0), equations.g);
  AddForces(b, g_i.Lane(1), g_j.Lane(1), equations.g);
  return true;
}

void Clear(const Problem& problem, NormalEquations& equations) {
  equations.g.setZero(6 * problem.free_count());
  equations.cost = 0.0;
}

}  // namespace

Vector6d Residual(const Constraint& constraint, const Poses& T_ref) {
  return EdgeStateAt(constraint, PoseOf(T_ref, constraint.i), PoseOf(T_ref, constraint.j)).e;
}

std::vector<Vector6d> Residuals(const Problem& problem, const Poses& T_ref) {
  const std::vector<Constraint>& constraints = problem.constraints;
  std::vector<Vector6d> residuals(constraints.size());
  for (std::size_t k = 0; k < constraints.size(); ++k) {
    pair::State state;
    if (k + 1 < constraints.size() && pair::StateAt(constraints[k], constraints[k + 1], T_ref, state)) {
      residuals[k] = state.e.Lane(0);
      residuals[++k] = state.e.Lane(1);
    } else {
      residuals[k] = Residual(constraints[k], T_ref);
    }
  }
  return residuals;
}

double Cost(const Problem& problem, const Poses& T_ref) { return Cost(problem, Residuals(problem, T_ref)); }

double Cost(const Problem& problem, const std::vector<Vector6d>& residuals) {
  double cost = 0.0;
  for (std::size_t k = 0; k < residuals.size(); ++k) {
    Vector6d weighted;
    weighted.noalias() = problem.constraints[k].Omega * residuals[k];
    cost += residuals[k].dot(weighted);
  }
  return cost;
}

void Linearize(const Problem& problem, const Poses& T_ref, NormalEquations& equations) {
  Clear(problem, equations);
  equations.H.Resize(problem.pattern);
  equations.H.SetZero();
  for (const Constraint& constraint : problem.constraints)
    AddHessian(constraint, AddGradient(constraint, T_ref, equations), equations.H);
}

void LinearizeRoughly(const Problem& problem, const Poses& T_ref, NormalEquations& equations) {
  LinearizeGradient(problem, T_ref, equations);
  equations.H.Resize(problem.pattern);
  equations.H.SetZero();
  for (const Constraint& constraint : problem.constraints)
    AddBlocks(constraint, constraint.Omega, constraint.T_i_j, equations.H);
}

void LinearizeEdge(const Constraint& constraint, const Poses& T_ref, BlockMatrix<6>& H, Eigen::VectorXd* g) {
  const EdgeState state = EdgeStateAt(constraint, PoseOf(T_ref, constraint.i), PoseOf(T_ref, constraint.j));
  AddHessian(constraint, state, H);
  if (g != nullptr) AddForces(constraint, state, *g);
}

void LinearizeGradient(const Problem& problem, const Poses& T_ref, NormalEquations& equations) {
  Clear(problem, equations);
  const std::vector<Constraint>& constraints = problem.constraints;
  for (std::size_t k = 0; k < constraints.size(); ++k) {
    if (k + 1 < constraints.size() && AddGradients(constraints[k], constraints[k + 1], T_ref, equations))
      ++k;
    else
      AddGradient(constraints[k], T_ref, equations);
  }
}

void Retract(const Poses& T_ref, const Eigen::VectorXd& step, Poses& result) {
  result.resize(T_ref.size());
  result[0] = T_ref[0];
  for (std::size_t v = 1; v < T_ref.size(); ++v)
    result[v] = (T_ref[v] * Se3::Exp(step.segment<6>(6 * (static_cast<Eigen::Index>(v) - 1)))).Normalized();
}

}  // namespace rigcal::graph
