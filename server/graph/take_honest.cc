#include <Eigen/Eigenvalues>

#include "server/graph/graph_jackknife.h"
#include "server/graph/linearize.h"
#include "server/math/covariance.h"

namespace rigcal::graph {
namespace {

// Below this share of an edge's own variance the other edges do not check a direction.
constexpr double kCheckedRatio = 1e-6;

void JudgeResidual(const Matrix6d& Omega, const ResidualCovariance& covariance, EdgeResidual& residual) {
  const Matrix6d W = SquareRoot(Omega).transpose();  // W^T W = Omega: whitens by what the edge says of itself
  const Eigen::SelfAdjointEigenSolver<Matrix6d> eigen(Symmetrized(W * covariance.C_e * W.transpose()));
  const Vector6d parts = eigen.eigenvectors().transpose() * (W * residual.e);
  residual.by_jackknife = true;
  residual.t_squared = 0.0;
  residual.rank = 0;
  for (int k = 0; k < 6; ++k) {
    if (!(eigen.eigenvalues()(k) > kCheckedRatio)) continue;
    ++residual.rank;
    residual.t_squared += parts(k) * parts(k) / eigen.eigenvalues()(k);
  }
  residual.dof = covariance.dof;
}

}  // namespace

void TakeHonest(const Graph& graph, const GraphJackknife& jackknife, GraphSolution& solution) {
  if (!jackknife.available) return;
  for (std::size_t s = 0; s < solution.poses.size(); ++s) {
    SensorPose& pose = solution.poses[s];
    const auto honest = SensorCovariance(jackknife, pose.sensor);
    if (!honest || pose.sensor == graph.reference) continue;
    pose.covariance_analytic = pose.covariance;
    pose.covariance = *honest;
    pose.by_jackknife = true;
    pose.dof = jackknife.dof[s];
  }
  std::map<EdgeId, const GraphEdge*> by_id;
  for (const GraphEdge& edge : graph.edges) by_id.emplace(edge.id, &edge);
  for (std::size_t k = 0; k < solution.residuals.size(); ++k)
    if (jackknife.residuals[k].in_solution)
      JudgeResidual(by_id.at(solution.residuals[k].edge)->Omega, jackknife.residuals[k], solution.residuals[k]);
}

}  // namespace rigcal::graph
