#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <optional>

#include "server/graph/insight/edge_checks.h"
#include "server/graph/insight/insight.h"
#include "server/graph/solve/start_poses.h"
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

// (I - S Omega)^-1 e, but for what the edge leaves open: there it disagrees with nobody.
Vector6d OffOf(const Constraint& c, const EdgeCheck& check, const Vector6d& pull) {
  const Vector6d off = check.jacobian.e + check.C_prediction * pull;
  if (c.rank == 6) return off;
  const auto open = Observable(c.Omega).unobservable_basis;
  return off - open * (open.transpose() * off);
}

// S^-1 - Omega, S what all edges together know it by, on what the edge measures: whitened by the edge's own covariance
// that is (1 - v) / v per direction.
Matrix6d KnownByOthers(const Matrix6d& Omega, const EdgeCheck& check) {
  constexpr double kKnownRatio = 1e-12;  // of the edge's own variance; less is no measurement's
  const Matrix6d F = SquareRoot(Omega);
  const Eigen::SelfAdjointEigenSolver<Matrix6d> own(Symmetrized(F.transpose() * check.C_prediction * F));
  Vector6d information = Vector6d::Zero();
  for (int k = 0; k < 6; ++k)
    if (const double share = own.eigenvalues()(k); 1.0 - share > kCheckedRatio)
      information(k) = (1.0 - share) / std::max(share, kKnownRatio);
  const Matrix6d G = F * own.eigenvectors();
  return Symmetrized(G * information.asDiagonal() * G.transpose());
}

// x without the edge, less x with it: P J^T pull.
Eigen::VectorXd MoveWithout(const Constraint& c, const EdgeCheck& check, const Vector6d& pull,
                            const Eigen::MatrixXd& P) {
  Eigen::VectorXd move = Eigen::VectorXd::Zero(P.rows());
  if (c.i > 0) move += P.middleCols<6>(6 * (c.i - 1)) * (check.jacobian.J_i.transpose() * pull);
  if (c.j > 0) move += P.middleCols<6>(6 * (c.j - 1)) * (check.jacobian.J_j.transpose() * pull);
  return move;
}

// The sensors whose pose the solution knows with a sigma, and how to count in those sigmas.
struct Ruler {
  int vertex = 0;
  const SensorPose* pose = nullptr;
  Eigen::LLT<Matrix6d> C;
};

std::vector<Ruler> RulersOf(const Problem& problem, const GraphSolution& solution) {
  std::vector<Ruler> rulers;
  for (int vertex = 1; vertex < problem.vertex_count; ++vertex) {
    const SensorPose& pose = solution.poses[problem.sensor_of_vertex[static_cast<std::size_t>(vertex)]];
    Eigen::LLT<Matrix6d> C(pose.covariance);
    if (pose.known && C.info() == Eigen::Success) rulers.push_back({vertex, &pose, std::move(C)});
  }
  return rulers;
}

void FindMostMoved(const std::vector<Ruler>& rulers, const Eigen::VectorXd& move, EdgeInfluence& influence) {
  for (const Ruler& ruler : rulers) {
    const Vector6d part = move.segment<6>(6 * (ruler.vertex - 1));
    const double sigmas = ruler.C.matrixL().solve(part).norm();
    if (!std::isfinite(sigmas) || (!(sigmas > influence.move_sigmas) && !influence.most_moved.empty())) continue;
    influence.most_moved = ruler.pose->sensor;
    influence.move = part;
    influence.move_sigmas = sigmas;
  }
}

std::string WhyNot(const Graph& graph, const GraphSolution& solution) {
  if (!solution.converged || solution.poses.size() != graph.sensors.size())
    return "Influence was left out: the graph did not settle.";
  if (graph.sensors.size() <= kInfluenceSensorsMax && graph.edges.size() <= kInfluenceEdgesMax) return "";
  return "Influence was left out: it is worked out up to " + std::to_string(kInfluenceSensorsMax) + " sensors and " +
         std::to_string(kInfluenceEdgesMax) + " edges, and this graph has " + std::to_string(graph.sensors.size()) +
         " and " + std::to_string(graph.edges.size()) + ".";
}

std::optional<EdgeChecks> ChecksAt(const Graph& graph, const Problem& problem, const GraphSolution& solution) {
  const Poses T_ref = SolvedPoses(graph, problem, solution);
  const auto cholesky = FactorAt(problem, T_ref);
  if (cholesky == nullptr) return std::nullopt;
  return CheckEdges(problem, T_ref, std::vector<bool>(problem.constraints.size(), true), *cholesky);
}

EdgeInfluence InfluenceOf(const Constraint& constraint, const EdgeCheck& check, const Eigen::MatrixXd& P,
                          const std::vector<Ruler>& rulers) {
  EdgeInfluence influence;
  influence.checked = check.rank > 0;
  influence.t_squared = check.t_squared;
  if (!influence.checked) return influence;
  const Vector6d pull = Pull(constraint.Omega, check);
  influence.off = OffOf(constraint, check, pull);
  FindMostMoved(rulers, MoveWithout(constraint, check, pull, P), influence);
  return influence;
}

}  // namespace

Influences InfluenceOfEdges(const Graph& graph, const GraphSolution& solution) {
  Influences influences;
  influences.why_not = WhyNot(graph, solution);
  if (!influences.why_not.empty()) return influences;
  const Problem problem = MakeProblem(graph);
  influences.judged = true;
  if (problem.free_count() == 0) return influences;
  const std::optional<EdgeChecks> checks = ChecksAt(graph, problem, solution);
  if (!checks) return {false, "Influence was left out: the edges do not hold the sensors.", {}};
  const std::vector<Ruler> rulers = RulersOf(problem, solution);
  for (std::size_t k = 0; k < problem.constraints.size(); ++k) {
    influences.edges.push_back(InfluenceOf(problem.constraints[k], checks->edges[k], checks->P, rulers));
    influences.edges.back().edge = graph.edges[problem.edges_by_id[problem.constraints[k].edge]].id;
  }
  return influences;
}

OtherPaths OtherPathsOf(const Graph& graph, const GraphSolution& solution) {
  OtherPaths others;
  const Problem problem = MakeProblem(graph);
  if (!WhyNot(graph, solution).empty() || problem.free_count() == 0) return others;
  const std::optional<EdgeChecks> checks = ChecksAt(graph, problem, solution);
  if (!checks) return others;
  for (std::size_t k = 0; k < problem.constraints.size(); ++k)
    others[graph.edges[problem.edges_by_id[problem.constraints[k].edge]].id] =
        KnownByOthers(problem.constraints[k].Omega, checks->edges[k]);
  return others;
}

}  // namespace rigcal::graph
