// The derivative of one edge's residual, as matrices: for what is done once per solution and not once per iteration.
#pragma once

#include "server/graph/linearize.h"

namespace rigcal::graph {

// e(T_i Exp(x_i), T_j Exp(x_j), T_i_j Exp(d)) = e + J_i x_i + J_j x_j + D d.
struct EdgeJacobian {
  Vector6d e = Vector6d::Zero();
  Matrix6d J_i = Matrix6d::Zero(), J_j = Matrix6d::Zero(), D = Matrix6d::Zero();
};
[[nodiscard]] EdgeJacobian JacobianOf(const Constraint& constraint, const Poses& T_ref);

// Columns += J_i^T Omega de, J_j^T Omega de at the rows of the two vertices (the reference has none).
void AddToGradient(const Constraint& constraint, const EdgeJacobian& jacobian, const Eigen::MatrixXd& de,
                   Eigen::Ref<Eigen::MatrixXd> columns);
// J_i x_i + J_j x_j of the columns x.
[[nodiscard]] Eigen::MatrixXd ResidualChange(const Constraint& constraint, const EdgeJacobian& jacobian,
                                             const Eigen::Ref<const Eigen::MatrixXd>& columns);

}  // namespace rigcal::graph
