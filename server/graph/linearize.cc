#include "server/graph/linearize.h"

namespace rigcal::graph {
namespace {

using Eigen::Matrix3d;

// [D U; 0 D]: both Jacobians of an edge have this shape, which saves half of every product.
struct UpperBlocks {
  Matrix3d D, U;
};

UpperBlocks BlocksOf(const Matrix6d& matrix) { return {matrix.topLeftCorner<3, 3>(), matrix.topRightCorner<3, 3>()}; }

UpperBlocks AdjointBlocks(const Se3& T) {
  const Matrix3d R = T.R();
  return {R, Hat(T.p_m) * R};
}

// S * [D U; 0 D].
Matrix6d TimesUpper(const Matrix6d& S, const UpperBlocks& A) {
  Matrix6d product;
  product.leftCols<3>().noalias() = S.leftCols<3>() * A.D;
  product.rightCols<3>().noalias() = S.leftCols<3>() * A.U + S.rightCols<3>() * A.D;
  return product;
}

// [D U; 0 D]^T * S.
Matrix6d UpperTransposedTimes(const UpperBlocks& A, const Matrix6d& S) {
  Matrix6d product;
  product.topRows<3>().noalias() = A.D.transpose() * S.topRows<3>();
  product.bottomRows<3>().noalias() = A.U.transpose() * S.topRows<3>() + A.D.transpose() * S.bottomRows<3>();
  return product;
}

Vector6d UpperTransposedTimes(const UpperBlocks& A, const Vector6d& v) {
  Vector6d product;
  product.head<3>() = A.D.transpose() * v.head<3>();
  product.tail<3>() = A.U.transpose() * v.head<3>() + A.D.transpose() * v.tail<3>();
  return product;
}

const Se3& PoseOf(const Poses& T_ref, int vertex) { return T_ref[static_cast<std::size_t>(vertex)]; }

// What an edge's gradient and Hessian share: J_j = Jr^-1(e), J_i = -J_j A with A = Ad(T_j^-1 T_i).
struct EdgeTerms {
  UpperBlocks J_j, A;
  Vector6d g_j;
};

EdgeTerms AddGradient(const Constraint& constraint, const Poses& T_ref, NormalEquations& equations) {
  EdgeTerms terms;
  const Se3 T_j_i = PoseOf(T_ref, constraint.j).Inverse() * PoseOf(T_ref, constraint.i);
  const Vector6d e = (constraint.T_j_i * T_j_i.Inverse()).Log();
  const Vector6d weighted = constraint.Omega * e;
  equations.cost += e.dot(weighted);
  terms.J_j = BlocksOf(RightJacobianInverse(e));
  terms.A = AdjointBlocks(T_j_i);
  terms.g_j = UpperTransposedTimes(terms.J_j, weighted);
  if (constraint.j > 0) equations.g.segment<6>(6 * (constraint.j - 1)) += terms.g_j;
  if (constraint.i > 0) equations.g.segment<6>(6 * (constraint.i - 1)) -= UpperTransposedTimes(terms.A, terms.g_j);
  return terms;
}

// One product W serves three blocks.
void AddHessian(const Constraint& constraint, const EdgeTerms& terms, BlockMatrix<6>& H) {
  const Matrix6d W = UpperTransposedTimes(terms.J_j, TimesUpper(constraint.Omega, terms.J_j));
  const auto i = static_cast<std::size_t>(constraint.i), j = static_cast<std::size_t>(constraint.j);
  if (j > 0) H.diagonal[j - 1] += W;
  if (i == 0) return;
  const Matrix6d WA = TimesUpper(W, terms.A);
  H.diagonal[i - 1] += UpperTransposedTimes(terms.A, WA);
  if (constraint.slot < 0) return;
  Matrix6d& block = H.off_diagonal[static_cast<std::size_t>(constraint.slot)];
  if (j > i) {
    block -= WA;
  } else {
    block -= WA.transpose();
  }
}

void Clear(const Problem& problem, NormalEquations& equations) {
  equations.g.setZero(6 * problem.free_count());
  equations.cost = 0.0;
}

}  // namespace

Vector6d Residual(const Constraint& constraint, const Poses& T_ref) {
  return (constraint.T_j_i * (PoseOf(T_ref, constraint.i).Inverse() * PoseOf(T_ref, constraint.j))).Log();
}

double Cost(const Problem& problem, const Poses& T_ref) {
  double cost = 0.0;
  for (const Constraint& constraint : problem.constraints) {
    const Vector6d e = Residual(constraint, T_ref);
    cost += e.dot(constraint.Omega * e);
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

void LinearizeGradient(const Problem& problem, const Poses& T_ref, NormalEquations& equations) {
  Clear(problem, equations);
  for (const Constraint& constraint : problem.constraints) AddGradient(constraint, T_ref, equations);
}

void Retract(const Poses& T_ref, const Eigen::VectorXd& step, Poses& result) {
  result.resize(T_ref.size());
  result[0] = T_ref[0];
  for (std::size_t v = 1; v < T_ref.size(); ++v)
    result[v] = (T_ref[v] * Se3::Exp(step.segment<6>(6 * (static_cast<Eigen::Index>(v) - 1)))).Normalized();
}

}  // namespace rigcal::graph
