#include "server/graph/chordal.h"

#include <Eigen/Cholesky>
#include <Eigen/SVD>
#include <algorithm>

namespace rigcal::graph {
namespace {

using Eigen::Matrix3d;
using Eigen::MatrixXd;

// Isotropic weight of a 3x3 information block: the harmonic mean of its eigenvalues; next to nothing for an edge with
// an unobservable direction, which only must not leave a vertex without any equation.
double WeightOf(const Constraint& constraint, int start) {
  const Matrix3d block = constraint.Omega.block<3, 3>(start, start);
  constexpr double kDeficient = 1e-6;
  if (constraint.rank < 6) return kDeficient * block.trace() / 3;
  return 3.0 / block.inverse().trace();
}

std::vector<double> Weights(const Problem& problem, int start) {
  std::vector<double> weights;
  weights.reserve(problem.constraints.size());
  for (const Constraint& constraint : problem.constraints) weights.push_back(WeightOf(constraint, start));
  const double largest = *std::max_element(weights.begin(), weights.end());
  for (double& weight : weights) weight = largest > 0.0 ? std::max(weight / largest, 1e-12) : 1.0;
  return weights;
}

// min sum w |R_j^T - R_ij^T R_i^T|^2: the unknowns are the transposed rotations, stacked; R_reference = I.
struct RotationSystem {
  BlockMatrix<3> matrix;
  MatrixXd rhs;
};

RotationSystem MakeRotationSystem(const Problem& problem) {
  RotationSystem system;
  system.matrix.Resize(problem.pattern);
  system.matrix.SetZero();
  system.rhs = MatrixXd::Zero(3 * problem.free_count(), 3);
  const std::vector<double> weights = Weights(problem, tangent::kRotation);
  for (std::size_t k = 0; k < weights.size(); ++k) {
    const Constraint& c = problem.constraints[k];
    const Matrix3d R_i_j = weights[k] * c.T_i_j.R();
    for (const int v : {c.i, c.j})
      if (v > 0) system.matrix.diagonal[static_cast<std::size_t>(v) - 1].diagonal().array() += weights[k];
    if (c.slot >= 0) {
      Matrix3d& block = system.matrix.off_diagonal[static_cast<std::size_t>(c.slot)];
      if (c.i > c.j)
        block -= R_i_j;
      else
        block -= R_i_j.transpose();
    } else if (c.i == 0) {
      system.rhs.middleRows<3>(3 * (c.j - 1)) += R_i_j.transpose();
    } else {
      system.rhs.middleRows<3>(3 * (c.i - 1)) += R_i_j;
    }
  }
  return system;
}

Matrix3d NearestRotation(const Matrix3d& matrix) {
  const Eigen::JacobiSVD<Matrix3d> svd(matrix, Eigen::ComputeFullU | Eigen::ComputeFullV);
  const double sign = (svd.matrixU() * svd.matrixV().transpose()).determinant() < 0.0 ? -1.0 : 1.0;
  return svd.matrixU() * Eigen::Vector3d(1.0, 1.0, sign).asDiagonal() * svd.matrixV().transpose();
}

bool SolveRotations(const Problem& problem, Poses& T_ref) {
  RotationSystem system = MakeRotationSystem(problem);
  const auto cholesky = MakeCholesky<3>(problem.pattern);
  if (cholesky == nullptr || !cholesky->Factor(system.matrix, 0.0)) return false;
  cholesky->SolveInPlace(system.rhs);
  if (!system.rhs.allFinite()) return false;
  for (int v = 1; v < problem.vertex_count; ++v) {
    const Matrix3d transposed = system.rhs.middleRows<3>(3 * (v - 1));
    T_ref[static_cast<std::size_t>(v)].q = Eigen::Quaterniond(NearestRotation(transposed.transpose()));
  }
  return true;
}

// min sum w |p_j - p_i - R_i p_ij|^2.
bool SolveTranslations(const Problem& problem, Poses& T_ref) {
  BlockMatrix<1> laplacian;
  laplacian.Resize(problem.pattern);
  laplacian.SetZero();
  MatrixXd p_m = MatrixXd::Zero(problem.free_count(), 3);
  const std::vector<double> weights = Weights(problem, tangent::kTranslation);
  for (std::size_t k = 0; k < weights.size(); ++k) {
    const Constraint& c = problem.constraints[k];
    const Eigen::Vector3d pull = weights[k] * (T_ref[static_cast<std::size_t>(c.i)].q * c.T_i_j.p_m);
    if (c.slot >= 0) laplacian.off_diagonal[static_cast<std::size_t>(c.slot)](0) -= weights[k];
    for (const auto& [v, sign] : {std::pair(c.i, -1.0), std::pair(c.j, 1.0)}) {
      if (v == 0) continue;
      laplacian.diagonal[static_cast<std::size_t>(v) - 1](0) += weights[k];
      p_m.row(v - 1) += sign * pull.transpose();
    }
  }
  const auto cholesky = MakeCholesky<1>(problem.pattern);
  if (cholesky == nullptr || !cholesky->Factor(laplacian, 0.0)) return false;
  cholesky->SolveInPlace(p_m);
  for (int v = 1; v < problem.vertex_count; ++v) T_ref[static_cast<std::size_t>(v)].p_m = p_m.row(v - 1);
  return p_m.allFinite();
}

}  // namespace

std::optional<Poses> ChordalPoses(const Problem& problem) {
  Poses T_ref(static_cast<std::size_t>(problem.vertex_count));
  if (problem.free_count() == 0) return T_ref;
  if (!SolveRotations(problem, T_ref) || !SolveTranslations(problem, T_ref)) return std::nullopt;
  for (Se3& T : T_ref) T = T.Normalized();
  return T_ref;
}

}  // namespace rigcal::graph
