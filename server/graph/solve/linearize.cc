#include "server/graph/solve/linearize.h"

#include <algorithm>
#include <array>

#include "server/graph/large/lane_kernels.h"
#include "server/graph/solve/edge_terms.h"

namespace rigcal::graph {
namespace {

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

// Four edges' W = J_j^T Omega J_j, which serves three blocks of H each.
class BlockSums {
 public:
  explicit BlockSums(BlockMatrix<6>& H) : H_(H) {}

  void Add(const Constraint& constraint, const Matrix6d& W, const Se3& T_i_j) {
    constraints_[count_] = &constraint;
    W_[count_] = W;
    T_i_j_[count_] = T_i_j;
    if (++count_ == kLanes) Finish();
  }

  // Adds what is still waiting: the last thing to call.
  void Finish() {
    if (count_ == 0) return;
    BlockLanes lanes;
    double *WA[kLanes], *AWA[kLanes];
    for (std::size_t lane = 0; lane < kLanes; ++lane) {
      const std::size_t known = lane < count_ ? lane : 0;  // the first stands in for those that are missing
      lanes.W[lane] = W_[known].data();
      lanes.p_i_j_m[lane] = T_i_j_[known].p_m.data();
      lanes.q_i_j[lane] = T_i_j_[known].q.coeffs().data();
      WA[lane] = WA_[lane].data();
      AWA[lane] = AWA_[lane].data();
    }
    Kernels().Blocks(lanes, WA, AWA);
    for (std::size_t lane = 0; lane < count_; ++lane) AddLane(*constraints_[lane], lane);
    count_ = 0;
  }

 private:
  void AddLane(const Constraint& constraint, std::size_t lane) {
    const auto i = static_cast<std::size_t>(constraint.i), j = static_cast<std::size_t>(constraint.j);
    if (j > 0) H_.diagonal[j - 1] += W_[lane];
    if (i == 0) return;
    H_.diagonal[i - 1] += AWA_[lane];
    if (constraint.slot < 0) return;
    Matrix6d& block = H_.off_diagonal[static_cast<std::size_t>(constraint.slot)];
    if (j > i)
      block -= WA_[lane];
    else
      block -= WA_[lane].transpose();
  }

  BlockMatrix<6>& H_;
  std::size_t count_ = 0;
  std::array<const Constraint*, kLanes> constraints_{};
  std::array<Matrix6d, kLanes> W_, WA_, AWA_;
  std::array<Se3, kLanes> T_i_j_;
};

void AddHessian(const Constraint& constraint, const EdgeState& state, BlockSums& sums) {
  const UpperBlocks J_j = JacobianOf(state.e);
  const Matrix6d half = TimesUpper(constraint.Omega, J_j).transpose();
  sums.Add(constraint, TimesUpper(half, J_j), state.T_i_j);
}

// Constraints `first` on; the last stands in for those that are missing.
EdgeLanes LanesOf(const std::vector<Constraint>& constraints, std::size_t first, const Poses& T_ref) {
  EdgeLanes lanes;
  for (std::size_t lane = 0; lane < kLanes; ++lane) {
    const Constraint& c = constraints[std::min(first + lane, constraints.size() - 1)];
    const Se3 &T_ref_i = PoseOf(T_ref, c.i), &T_ref_j = PoseOf(T_ref, c.j);
    lanes.Omega[lane] = c.Omega.data();
    lanes.p_j_i_m[lane] = c.T_j_i.p_m.data();
    lanes.q_j_i[lane] = c.T_j_i.q.coeffs().data();
    lanes.p_i_m[lane] = T_ref_i.p_m.data();
    lanes.q_i[lane] = T_ref_i.q.coeffs().data();
    lanes.p_j_m[lane] = T_ref_j.p_m.data();
    lanes.q_j[lane] = T_ref_j.q.coeffs().data();
  }
  return lanes;
}

Vector6d LaneOf(const EdgeTwists& twists, std::size_t lane) {
  Vector6d twist;
  for (int k = 0; k < 6; ++k) twist(k) = twists.numbers[k][lane];
  return twist;
}

void AddForces(const Constraint& constraint, const EdgeForces& forces, std::size_t lane, NormalEquations& equations) {
  equations.cost += forces.cost[lane];
  if (constraint.j > 0) equations.g.segment<6>(6 * (constraint.j - 1)) += LaneOf(forces.on_j, lane);
  if (constraint.i > 0) equations.g.segment<6>(6 * (constraint.i - 1)) -= LaneOf(forces.on_i, lane);
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
  for (std::size_t first = 0; first < constraints.size(); first += kLanes) {
    EdgeTwists e;
    const bool small = Kernels().Residuals(LanesOf(constraints, first, T_ref), e);
    for (std::size_t k = first; k < std::min(first + kLanes, constraints.size()); ++k)
      residuals[k] = small ? LaneOf(e, k - first) : Residual(constraints[k], T_ref);
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
  equations.H.SetZero(problem.pattern);
  BlockSums sums(equations.H);
  for (const Constraint& constraint : problem.constraints)
    AddHessian(constraint, AddGradient(constraint, T_ref, equations), sums);
  sums.Finish();
}

void LinearizeRoughly(const Problem& problem, const Poses& T_ref, NormalEquations& equations) {
  LinearizeGradient(problem, T_ref, equations);
  equations.H.SetZero(problem.pattern);
  BlockSums sums(equations.H);
  for (const Constraint& constraint : problem.constraints) sums.Add(constraint, constraint.Omega, constraint.T_i_j);
  sums.Finish();
}

void LinearizeEdge(const Constraint& constraint, const Poses& T_ref, BlockMatrix<6>& H, Eigen::VectorXd* g) {
  const EdgeState state = EdgeStateAt(constraint, PoseOf(T_ref, constraint.i), PoseOf(T_ref, constraint.j));
  BlockSums sums(H);
  AddHessian(constraint, state, sums);
  sums.Finish();
  if (g != nullptr) AddForces(constraint, state, *g);
}

void LinearizeGradient(const Problem& problem, const Poses& T_ref, NormalEquations& equations) {
  Clear(problem, equations);
  const std::vector<Constraint>& constraints = problem.constraints;
  for (std::size_t first = 0; first < constraints.size(); first += kLanes) {
    EdgeForces forces;
    const bool small = Kernels().Forces(LanesOf(constraints, first, T_ref), forces);
    for (std::size_t k = first; k < std::min(first + kLanes, constraints.size()); ++k) {
      if (small)
        AddForces(constraints[k], forces, k - first, equations);
      else
        AddGradient(constraints[k], T_ref, equations);
    }
  }
}

void Retract(const Poses& T_ref, const Eigen::VectorXd& step, Poses& result) {
  result.resize(T_ref.size());
  result[0] = T_ref[0];
  for (std::size_t v = 1; v < T_ref.size(); ++v)
    result[v] = (T_ref[v] * Se3::Exp(step.segment<6>(6 * (static_cast<Eigen::Index>(v) - 1)))).Normalized();
}

EdgeJacobian JacobianOf(const Constraint& constraint, const Poses& T_ref) {
  EdgeJacobian jacobian;
  jacobian.e = Residual(constraint, T_ref);
  jacobian.J_j = RightJacobianInverse(jacobian.e);
  jacobian.J_i = -jacobian.J_j * Adjoint(T_ref[static_cast<std::size_t>(constraint.j)].Inverse() *
                                         T_ref[static_cast<std::size_t>(constraint.i)]);
  jacobian.D = -RightJacobianInverse(-jacobian.e);
  return jacobian;
}

void AddToGradient(const Constraint& constraint, const EdgeJacobian& jacobian, const Eigen::MatrixXd& de,
                   Eigen::Ref<Eigen::MatrixXd> columns) {
  const Eigen::MatrixXd weighted = constraint.Omega * de;
  if (constraint.i > 0) columns.middleRows<6>(6 * (constraint.i - 1)) += jacobian.J_i.transpose() * weighted;
  if (constraint.j > 0) columns.middleRows<6>(6 * (constraint.j - 1)) += jacobian.J_j.transpose() * weighted;
}

Eigen::MatrixXd ResidualChange(const Constraint& constraint, const EdgeJacobian& jacobian,
                               const Eigen::Ref<const Eigen::MatrixXd>& columns) {
  Eigen::MatrixXd change = Eigen::MatrixXd::Zero(6, columns.cols());
  if (constraint.i > 0) change += jacobian.J_i * columns.middleRows<6>(6 * (constraint.i - 1));
  if (constraint.j > 0) change += jacobian.J_j * columns.middleRows<6>(6 * (constraint.j - 1));
  return change;
}

}  // namespace rigcal::graph
