#include "server/graph/edge_influence.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <cmath>

#include "server/graph/edge_checks.h"
#include "server/graph/solved_poses.h"
#include "server/math/covariance.h"

namespace rigcal::graph {
namespace {

constexpr double kCheckedRatio = 1e-6;

// Omega (I - S Omega)^-1 e, by way of the whitened residual: its covariance is I - F^T S F. Directions that only this
// edge sees have a residual of zero and move nothing.
Vector6d Pull(const Matrix6d& Omega, const EdgeCheck& check) {
  const Matrix6d F = SquareRoot(Omega);
  const Eigen::SelfAdjointEigenSolver<Matrix6d> own(Symmetrized(F.transpose() * check.C_prediction * F));
  Vector6d parts = own.eigenvectors().transpose() * F.transpose() * check.jacobian.e;
  for (int k = 0; k < 6; ++k) {
    const double variance = 1.0 - own.eigenvalues()(k);
    parts(k) = variance > kCheckedRatio ? parts(k) / variance : 0.0;
  }
  return F * own.eigenvectors() * parts;
}

// x without the edge, less x with it: P J^T Omega (I - S Omega)^-1 e.
Eigen::VectorXd MoveWithout(const Constraint& c, const EdgeCheck& check, const Eigen::MatrixXd& P) {
  const Vector6d pull = Pull(c.Omega, check);
  Eigen::VectorXd move = Eigen::VectorXd::Zero(P.rows());
  if (c.i > 0) move += P.middleCols<6>(6 * (c.i - 1)) * (check.jacobian.J_i.transpose() * pull);
  if (c.j > 0) move += P.middleCols<6>(6 * (c.j - 1)) * (check.jacobian.J_j.transpose() * pull);
  return move;
}

void FindMostMoved(const Graph& graph, const Problem& problem, const EdgeChecks& checks, const Eigen::VectorXd& move,
                   EdgeInfluence& influence) {
  for (int vertex = 1; vertex < problem.vertex_count; ++vertex) {
    const Eigen::Index row = 6 * (vertex - 1);
    const Vector6d part = move.segment<6>(row);
    const Matrix6d C = checks.P.block<6, 6>(row, row);
    const double sigmas = std::sqrt(std::max(0.0, part.dot(C.ldlt().solve(part))));
    if (!(sigmas > influence.move_sigmas) && !influence.most_moved.empty()) continue;
    influence.most_moved = graph.sensors[problem.sensor_of_vertex[static_cast<std::size_t>(vertex)]];
    influence.move = part;
    influence.move_sigmas = sigmas;
  }
}

}  // namespace

std::vector<EdgeInfluence> InfluenceOfEdges(const Graph& graph, const GraphSolution& solution) {
  const Problem problem = MakeProblem(graph);
  if (!solution.converged || problem.free_count() == 0 || problem.free_count() >= kChecksSensorsMax) return {};
  const Poses T_ref = SolvedPoses(graph, problem, solution);
  NormalEquations equations;
  Linearize(problem, T_ref, equations);
  AddPins(Observe(problem, T_ref).pins, equations.H);
  const auto cholesky = MakeCholesky<6>(problem.pattern);
  if (cholesky == nullptr || !cholesky->Factor(equations.H, 0.0)) return {};
  const EdgeChecks checks = CheckEdges(problem, T_ref, std::vector<bool>(problem.constraints.size(), true), *cholesky);
  std::vector<EdgeInfluence> influences;
  for (std::size_t k = 0; k < problem.constraints.size(); ++k) {
    EdgeInfluence influence;
    influence.edge = graph.edges[problem.edges_by_id[problem.constraints[k].edge]].id;
    influence.checked = checks.edges[k].rank > 0;
    influence.t_squared = checks.edges[k].t_squared;
    if (influence.checked)
      FindMostMoved(graph, problem, checks, MoveWithout(problem.constraints[k], checks.edges[k], checks.P), influence);
    influences.push_back(influence);
  }
  return influences;
}

}  // namespace rigcal::graph
