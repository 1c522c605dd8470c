#include "server/graph/edge_jacobian.h"

#include <Eigen/Eigenvalues>
#include <cmath>

namespace rigcal::graph {

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
