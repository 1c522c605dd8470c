#include "server/graph/edge_checks.h"

#include <Eigen/Eigenvalues>

#include "server/math/covariance.h"

namespace rigcal::graph {
namespace {

// Below this share of an edge's own variance nothing checks a direction: the solution follows the edge.
constexpr double kCheckedRatio = 1e-6;

// J P J^T of both ends.
Matrix6d PredictionOf(const Constraint& c, const EdgeJacobian& jacobian, const Eigen::MatrixXd& P) {
  Matrix6d S = Matrix6d::Zero();
  const int i = 6 * (c.i - 1), j = 6 * (c.j - 1);
  if (c.i > 0) S += jacobian.J_i * P.block<6, 6>(i, i) * jacobian.J_i.transpose();
  if (c.j > 0) S += jacobian.J_j * P.block<6, 6>(j, j) * jacobian.J_j.transpose();
  if (c.i > 0 && c.j > 0) {
    const Matrix6d cross = jacobian.J_i * P.block<6, 6>(i, j) * jacobian.J_j.transpose();
    S += cross + cross.transpose();
  }
  return Symmetrized(S);
}

void Test(const Matrix6d& Omega, bool counts, EdgeCheck& check) {
  const Matrix6d root = SquareRoot(Omega);  // whitens by the edge's own covariance; its null space drops out
  const Vector6d white = root.transpose() * check.jacobian.e;
  const Matrix6d C = root.transpose() * check.C_prediction * root;
  const Eigen::SelfAdjointEigenSolver<Matrix6d> own(Symmetrized(C));
  const Vector6d parts = own.eigenvectors().transpose() * white;
  const double information_min = 1e-12 * (root.transpose() * root).diagonal().maxCoeff();
  for (int k = 0; k < 6; ++k) {
    // Whitened, the edge's own covariance is the identity on what it sees.
    if ((root * own.eigenvectors().col(k)).squaredNorm() <= information_min) continue;
    const double variance = counts ? 1.0 - own.eigenvalues()(k) : 1.0 + own.eigenvalues()(k);
    if (!(variance > kCheckedRatio)) continue;
    ++check.rank;
    check.t_squared += parts(k) * parts(k) / variance;
  }
}

}  // namespace

EdgeChecks CheckEdges(const Problem& problem, const Poses& T_ref, const std::vector<bool>& counts,
                      BlockCholesky<6>& cholesky) {
  EdgeChecks checks;
  const Eigen::Index n = 6 * problem.free_count();
  checks.P = Eigen::MatrixXd::Identity(n, n);
  cholesky.SolveInPlace(checks.P);
  checks.edges.resize(problem.constraints.size());
  for (std::size_t k = 0; k < checks.edges.size(); ++k) {
    EdgeCheck& check = checks.edges[k];
    check.jacobian = JacobianOf(problem.constraints[k], T_ref);
    check.C_prediction = PredictionOf(problem.constraints[k], check.jacobian, checks.P);
    Test(problem.constraints[k].Omega, counts[k], check);
  }
  return checks;
}

}  // namespace rigcal::graph
