#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/SVD>
#include <algorithm>
#include <cmath>

#include "server/calib/planes/static_planes.h"
#include "server/math/covariance.h"

namespace rigcal::calib {
namespace {

using Eigen::MatrixXd;

constexpr double kNoNoise_m = 1e-8, kNoNoise_rad = 1e-8;  // of perfect poses: rounding of the points
constexpr double kNoTurn_ratio = 0.1;

// Information on T_body_lidar with the planes eliminated, and how the planes follow it.
struct OfLidar {
  Matrix6d information;
  MatrixXd planes_follow;  // 3 per plane x 6
};

OfLidar EliminatePlanes(const StaticNormal& normal) {
  const Eigen::Index planes = normal.H.rows() - 6;
  const MatrixXd mixed = normal.H.bottomLeftCorner(planes, 6);
  OfLidar of;
  of.planes_follow = -normal.H.bottomRightCorner(planes, planes).ldlt().solve(mixed);
  of.information = normal.H.topLeftCorner<6, 6>() + mixed.transpose() * of.planes_follow;
  return of;
}

// How a capture's sightings change with T_body_lidar where the planes follow, the body at T_world_body.
std::vector<Eigen::Matrix<double, 7, 6>> ChangesAt(const StaticProblem& problem, const StaticState& state,
                                                   const MatrixXd& planes_follow, std::size_t k,
                                                   const Se3& T_world_body) {
  std::vector<Eigen::Matrix<double, 7, 6>> changes;
  for (const PlaneSighting& seen : problem.captures[k].seen) {
    const SightingJacobian at =
        JacobianAt(T_world_body, state.T_body_lidar, state.planes[seen.plane_idx], problem.range_bias_m);
    changes.emplace_back(at.by_lidar +
                         at.by_plane * planes_follow.middleRows<3>(3 * static_cast<Eigen::Index>(seen.plane_idx)));
  }
  return changes;
}

// What the capture says of such changes when its body's pose is not known but for the tracker.
Matrix6d InformationOf(const StaticProblem& problem, const StaticState& state, std::size_t k,
                       const std::vector<Eigen::Matrix<double, 7, 6>>& changes) {
  Matrix6d own = problem.captures[k].covariance.inverse(), mixed = Matrix6d::Zero(), information = Matrix6d::Zero();
  for (std::size_t i = 0; i < changes.size(); ++i) {
    const PlaneSighting& seen = problem.captures[k].seen[i];
    const auto by_body =
        JacobianAt(state.T_world_body[k], state.T_body_lidar, state.planes[seen.plane_idx], problem.range_bias_m)
            .by_body;
    own += by_body.transpose() * seen.moments.sum * by_body;
    mixed += by_body.transpose() * seen.moments.sum * changes[i];
    information += changes[i].transpose() * seen.moments.sum * changes[i];
  }
  return information - mixed.transpose() * own.ldlt().solve(mixed);
}

// One sigma of what is still open of a body's pose once its sightings have corrected it, in six independent ways.
Matrix6d PoseNoise(const StaticNormal::Body& body) {
  const Vector6d least = EachAxis(kNoNoise_m * kNoNoise_m, kNoNoise_rad * kNoNoise_rad);
  return (Symmetrized(body.inverse) + Matrix6d(least.asDiagonal())).llt().matrixL();
}

// What noise of the poses alone makes: each pose off by a sigma in each way.
Matrix6d OfNoise(const StaticProblem& problem, const StaticState& state, const StaticNormal& normal,
                 const MatrixXd& planes_follow) {
  Matrix6d noise = Matrix6d::Zero();
  for (std::size_t k = 0; k < problem.captures.size(); ++k) {
    const Matrix6d ways = PoseNoise(normal.bodies[k]);
    for (int i = 0; i < 6; ++i) {
      const Vector6d off = ways.col(i);
      auto changes = ChangesAt(problem, state, planes_follow, k, state.T_world_body[k] * Se3::Exp(off));
      const auto before = ChangesAt(problem, state, planes_follow, k, state.T_world_body[k] * Se3::Exp(-off));
      for (std::size_t s = 0; s < changes.size(); ++s) changes[s] = 0.5 * (changes[s] - before[s]);
      noise += InformationOf(problem, state, k, changes);
    }
  }
  return noise;
}

}  // namespace

PlaneReach ObservableByPlanes(const StaticProblem& problem, const StaticState& state) {
  StaticProblem whole = problem;
  whole.free = Matrix6d::Identity();
  const StaticNormal normal = NormalOf(whole, state);
  const OfLidar of = EliminatePlanes(normal);
  const Matrix6d noise = OfNoise(whole, state, normal, of.planes_follow), both = of.information + noise;
  const Vector6d scale = UnitDiagonal(both);
  const Matrix6d scaled_both = scale.asDiagonal() * both * scale.asDiagonal();
  const Matrix6d scaled_noise = scale.asDiagonal() * noise * scale.asDiagonal();
  // Shares of noise in what the poses seem to tell, 0 to 1, the most doubtful direction last.
  const Eigen::GeneralizedSelfAdjointEigenSolver<Matrix6d> shares(
      0.5 * (scaled_noise + scaled_noise.transpose()),
      0.5 * (scaled_both + scaled_both.transpose()) + 1e-14 * Matrix6d::Identity());
  const double open_from = 1 / (2 + kReachNoises * kReachNoises);
  PlaneReach reach;
  const double worst = std::clamp(shares.eigenvalues()[5], 1e-12, 1.0);
  reach.weakest_noises = std::sqrt(std::max(0.0, (1 - worst) / worst - 1));
  Eigen::Index open = 0;
  while (open < 6 && shares.eigenvalues()[5 - open] > open_from) ++open;
  const SplitDirections split = SplitBy(scale.asDiagonal() * shares.eigenvectors().rightCols(open));
  reach.open = split.within;
  reach.free = split.across;
  return reach;
}

OpenAxes AxesOf(const PlaneReach& reach, const Se3& T_body_lidar) {
  OpenAxes axes;
  if (reach.open.cols() == 0) return axes;
  const Eigen::Matrix3d R = T_body_lidar.R();
  const MatrixXd turns = R * reach.open.bottomRows<3>(), shifts = R * reach.open.topRows<3>();
  const Eigen::JacobiSVD<MatrixXd> svd(turns, Eigen::ComputeThinU | Eigen::ComputeFullV);
  for (Eigen::Index i = 0; i < reach.open.cols(); ++i) {
    const bool turned = i < svd.singularValues().size() && svd.singularValues()[i] > kNoTurn_ratio;
    if (turned)
      axes.turns.push_back(svd.matrixU().col(i));
    else
      axes.positions.push_back((shifts * svd.matrixV().col(i)).normalized());
  }
  return axes;
}

}  // namespace rigcal::calib
