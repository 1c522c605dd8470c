// Residuals, cost and normal equations of a Problem at given poses (paper, section III-B, its H and b). Right tangents,
// m and rad, at the vertices; a residual is one at frame_b of its edge.
#pragma once

#include <vector>

#include "server/graph/solve/problem.h"

namespace rigcal::graph {

// Poses T_ref_vertex; [0] is the reference's identity.
using Poses = std::vector<Se3>;

// H dx = -g is the Gauss-Newton step of `cost` = sum e^T Omega e (H = J^T Omega J, g = J^T Omega e).
struct NormalEquations {
  BlockMatrix<6> H;
  Eigen::VectorXd g;
  double cost = 0.0;
};

// e = Log(T_i_j_measured^-1 T_i^-1 T_j).
[[nodiscard]] Vector6d Residual(const Constraint& constraint, const Poses& T_ref);
[[nodiscard]] std::vector<Vector6d> Residuals(const Problem& problem, const Poses& T_ref);
[[nodiscard]] double Cost(const Problem& problem, const std::vector<Vector6d>& residuals);
[[nodiscard]] double Cost(const Problem& problem, const Poses& T_ref);
// Analytic, with the full inverse right Jacobian of SE(3). Allocates only on the first call with `equations`.
void Linearize(const Problem& problem, const Poses& T_ref, NormalEquations& equations);
// The same with H as if every residual were zero: near enough for a first step from a fair start, at half the work.
void LinearizeRoughly(const Problem& problem, const Poses& T_ref, NormalEquations& equations);
// Adds one edge to H, and to g if given.
void LinearizeEdge(const Constraint& constraint, const Poses& T_ref, BlockMatrix<6>& H, Eigen::VectorXd* g = nullptr);
// Cost and gradient alone; H stays as it is.
void LinearizeGradient(const Problem& problem, const Poses& T_ref, NormalEquations& equations);
// T * Exp(step), vertex by vertex; the reference stays.
void Retract(const Poses& T_ref, const Eigen::VectorXd& step, Poses& result);

// One edge's derivative as matrices: for what is done once per solution and not once per iteration.
// e(T_i Exp(x_i), T_j Exp(x_j), T_i_j Exp(d)) = e + J_i x_i + J_j x_j + D d.
struct EdgeJacobian {
  Vector6d e = Vector6d::Zero();
  Matrix6d J_i = Matrix6d::Zero(), J_j = Matrix6d::Zero(), D = Matrix6d::Zero();
};
// At the poses `T_ref` of the vertices, the reference among them.
[[nodiscard]] EdgeJacobian JacobianOf(const Constraint& constraint, const Poses& T_ref);

// Columns += J_i^T Omega de, J_j^T Omega de at the rows of the two vertices (the reference has none).
void AddToGradient(const Constraint& constraint, const EdgeJacobian& jacobian, const Eigen::MatrixXd& de,
                   Eigen::Ref<Eigen::MatrixXd> columns);
// J_i x_i + J_j x_j of the columns x.
[[nodiscard]] Eigen::MatrixXd ResidualChange(const Constraint& constraint, const EdgeJacobian& jacobian,
                                             const Eigen::Ref<const Eigen::MatrixXd>& columns);

}  // namespace rigcal::graph
