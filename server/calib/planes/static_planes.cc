#include "server/calib/planes/static_planes.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "server/math/covariance.h"

namespace rigcal::calib {
namespace {

constexpr int kHalvingsMax = 20;
constexpr double kStepTolerance = 1e-11;       // metres and radians
constexpr double kEigenvalueSmallest = 1e-12;  // after scaling to a unit diagonal

using Basis = Eigen::Matrix<double, 3, 2>;

// Two axes across a plane's normal; the same normal gives the same.
Basis AcrossOf(const Eigen::Vector3d& normal) {
  int least = 0;
  normal.cwiseAbs().minCoeff(&least);
  Basis across;
  across.col(0) = normal.cross(Eigen::Vector3d::Unit(least)).normalized();
  across.col(1) = normal.cross(across.col(0));
  return across;
}

WorldPlane MovedBy(const WorldPlane& plane, const Eigen::Vector3d& step) {
  WorldPlane moved;
  moved.normal = (plane.normal + AcrossOf(plane.normal) * step.head<2>()).normalized();
  moved.distance_m = plane.distance_m + step[2];
  return moved;
}

Vector6d BodyResidual(const StaticProblem& problem, const StaticState& state, std::size_t k) {
  return (problem.captures[k].T_world_body.Inverse() * state.T_world_body[k]).Log();
}

double CostOf(const StaticProblem& problem, const StaticState& state) {
  double cost = 0;
  for (std::size_t k = 0; k < problem.captures.size(); ++k) {
    const Vector6d e = BodyResidual(problem, state, k);
    cost += e.dot(problem.captures[k].covariance.llt().solve(e));
    for (const PlaneSighting& seen : problem.captures[k].seen) {
      const Vector7d g =
          PlaneInLidar(state.T_world_body[k], state.T_body_lidar, state.planes[seen.plane_idx], problem.range_bias_m);
      cost += g.dot(seen.moments.sum * g);
    }
  }
  return cost;
}

Eigen::Index PlaneAt(const StaticProblem& problem, std::size_t plane_idx) {
  return problem.free.cols() + 3 * static_cast<Eigen::Index>(plane_idx);
}

// Adds one capture, its body eliminated.
void AddCapture(const StaticProblem& problem, const StaticState& state, std::size_t k, StaticNormal& normal) {
  const Eigen::Index size = normal.gradient.size(), f = problem.free.cols();
  const StaticCapture& capture = problem.captures[k];
  const Vector6d e = BodyResidual(problem, state, k);
  const Matrix6d J = RightJacobianInverse(e), weight = capture.covariance.inverse();
  Matrix6d own = J.transpose() * weight * J;
  StaticNormal::Body body;
  body.gradient = J.transpose() * weight * e;
  body.mixed = Eigen::MatrixXd::Zero(6, size);
  for (const PlaneSighting& seen : capture.seen) {
    const SightingJacobian at =
        JacobianAt(state.T_world_body[k], state.T_body_lidar, state.planes[seen.plane_idx], problem.range_bias_m);
    const Matrix7d& M = seen.moments.sum;
    const Eigen::Matrix<double, 7, Eigen::Dynamic> by_free = at.by_lidar * problem.free;
    const Eigen::Index p = PlaneAt(problem, seen.plane_idx);
    const Eigen::Matrix<double, 6, 7> body_M = at.by_body.transpose() * M;
    own += body_M * at.by_body;
    body.gradient += body_M * at.g;
    body.mixed.leftCols(f) += body_M * by_free;
    body.mixed.middleCols<3>(p) += body_M * at.by_plane;
    normal.H.topLeftCorner(f, f) += by_free.transpose() * M * by_free;
    normal.H.block<3, 3>(p, p) += at.by_plane.transpose() * M * at.by_plane;
    const Eigen::MatrixXd mixed = by_free.transpose() * M * at.by_plane;
    normal.H.block(0, p, f, 3) += mixed;
    normal.H.block(p, 0, 3, f) += mixed.transpose();
    normal.gradient.head(f) += by_free.transpose() * (M * at.g);
    normal.gradient.segment<3>(p) += at.by_plane.transpose() * (M * at.g);
  }
  body.inverse = own.inverse();
  normal.H -= body.mixed.transpose() * body.inverse * body.mixed;
  normal.gradient -= body.mixed.transpose() * (body.inverse * body.gradient);
  normal.bodies.push_back(std::move(body));
}

Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> ScaledAxes(const Eigen::MatrixXd& H, const Eigen::VectorXd& scale) {
  const Eigen::MatrixXd scaled = scale.asDiagonal() * H * scale.asDiagonal();
  return Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(0.5 * (scaled + scaled.transpose()));
}

Eigen::VectorXd StepOf(const StaticNormal& normal) {
  const Eigen::VectorXd scale = UnitDiagonal(normal.H);
  const auto axes = ScaledAxes(normal.H, scale);
  Eigen::VectorXd along = axes.eigenvectors().transpose() * (scale.asDiagonal() * normal.gradient);
  for (Eigen::Index i = 0; i < along.size(); ++i)
    along[i] = axes.eigenvalues()[i] > kEigenvalueSmallest ? -along[i] / axes.eigenvalues()[i] : 0.0;
  return scale.asDiagonal() * (axes.eigenvectors() * along);
}

StaticState Moved(const StaticProblem& problem, const StaticState& state, const StaticNormal& normal,
                  const Eigen::VectorXd& step, double length) {
  StaticState moved = state;
  const Vector6d xi = problem.free * step.head(problem.free.cols());
  moved.T_body_lidar = (state.T_body_lidar * Se3::Exp(length * xi)).Normalized();
  for (std::size_t i = 0; i < state.planes.size(); ++i)
    moved.planes[i] = MovedBy(state.planes[i], length * step.segment<3>(PlaneAt(problem, i)));
  for (std::size_t k = 0; k < normal.bodies.size(); ++k) {
    const StaticNormal::Body& body = normal.bodies[k];
    const Vector6d follow = -(body.inverse * (body.gradient + body.mixed * step));
    moved.T_world_body[k] = (state.T_world_body[k] * Se3::Exp(length * follow)).Normalized();
  }
  return moved;
}

}  // namespace

Vector7d PlaneInLidar(const Se3& T_world_body, const Se3& T_body_lidar, const WorldPlane& plane, double range_bias_m) {
  const Eigen::Vector3d n_lidar = T_body_lidar.R().transpose() * (T_world_body.R().transpose() * plane.normal);
  Vector7d g;
  g << n_lidar, range_bias_m * n_lidar, plane.normal.dot(T_world_body * T_body_lidar.p_m) - plane.distance_m;
  return g;
}

// T_body_lidar Exp([v, w]) moves the plane (a, c) by da = a x w, dc = a . v; T_world_body Exp([v, w]) by da = R^T (m x
// w), dc = m . v + (t x m) . w, with m the normal in the body's frame.
SightingJacobian JacobianAt(const Se3& T_world_body, const Se3& T_body_lidar, const WorldPlane& plane,
                            double range_bias_m) {
  SightingJacobian at;
  at.g = PlaneInLidar(T_world_body, T_body_lidar, plane, range_bias_m);
  const Eigen::Matrix3d R_lidar_body = T_body_lidar.R().transpose(), R_body_world = T_world_body.R().transpose();
  const Eigen::Vector3d a = at.g.head<3>(), m = R_body_world * plane.normal;
  const Basis across = AcrossOf(plane.normal);
  at.by_lidar.setZero();
  at.by_body.setZero();
  at.by_plane.setZero();
  at.by_lidar.block<3, 3>(0, 3) = Hat(a);
  at.by_lidar.block<1, 3>(6, 0) = a.transpose();
  at.by_body.block<3, 3>(0, 3) = R_lidar_body * Hat(m);
  at.by_body.block<1, 3>(6, 0) = m.transpose();
  at.by_body.block<1, 3>(6, 3) = T_body_lidar.p_m.cross(m).transpose();
  at.by_plane.block<3, 2>(0, 0) = R_lidar_body * R_body_world * across;
  at.by_plane.block<1, 2>(6, 0) = (T_world_body * T_body_lidar.p_m).transpose() * across;
  at.by_plane(6, 2) = -1;
  at.by_lidar.middleRows<3>(3) = range_bias_m * at.by_lidar.topRows<3>();
  at.by_body.middleRows<3>(3) = range_bias_m * at.by_body.topRows<3>();
  at.by_plane.middleRows<3>(3) = range_bias_m * at.by_plane.topRows<3>();
  return at;
}

StaticNormal NormalOf(const StaticProblem& problem, const StaticState& state) {
  const Eigen::Index size = PlaneAt(problem, state.planes.size());
  StaticNormal normal{Eigen::MatrixXd::Zero(size, size), Eigen::VectorXd::Zero(size), {}};
  for (std::size_t k = 0; k < problem.captures.size(); ++k) AddCapture(problem, state, k, normal);
  return normal;
}

Result<StaticSolution> SolveStatic(const StaticProblem& problem, const StaticState& start, int iterations_max) {
  StaticSolution solution{start, CostOf(problem, start), 0};
  for (; solution.iterations < iterations_max; ++solution.iterations) {
    const StaticNormal normal = NormalOf(problem, solution.state);
    if (!normal.H.allFinite() || !normal.gradient.allFinite()) break;
    const Eigen::VectorXd step = StepOf(normal);
    if (step.norm() < kStepTolerance) return solution;
    double length = 1;
    StaticState moved = Moved(problem, solution.state, normal, step, length);
    double cost = CostOf(problem, moved);
    for (int halving = 0; halving < kHalvingsMax && !(cost <= solution.cost); ++halving) {
      length /= 2;
      moved = Moved(problem, solution.state, normal, step, length);
      cost = CostOf(problem, moved);
    }
    if (!(cost < solution.cost)) return solution;  // as deep as rounding lets it see
    solution.state = std::move(moved);
    solution.cost = cost;
  }
  // Along a direction that is hardly observed the steps shrink slowly; what they still gain is far below the noise.
  if (std::isfinite(solution.cost) && solution.iterations > 0) return solution;
  return Fail(ErrorCode::kInvalidInput, "the refinement of the lidar's pose did not converge",
              "Check that poses and clouds of one name are of one instant, and take more captures.");
}

Result<StaticFit> FitOf(const StaticProblem& problem, const StaticState& state) {
  const StaticNormal normal = NormalOf(problem, state);
  const Eigen::VectorXd scale = UnitDiagonal(normal.H);
  const auto axes = ScaledAxes(normal.H, scale);
  if (!normal.H.allFinite() || !(axes.eigenvalues().minCoeff() > kEigenvalueSmallest))
    return Fail(ErrorCode::kInvalidInput, "the boards and the motion leave a direction open",
                "Turn the robot about different axes, before boards that face different ways.");
  const Eigen::MatrixXd half = scale.asDiagonal() * axes.eigenvectors();
  const Eigen::MatrixXd C = half * axes.eigenvalues().cwiseInverse().asDiagonal() * half.transpose();
  StaticFit fit;
  fit.C_lidar = C.topLeftCorner(problem.free.cols(), problem.free.cols());
  fit.dof = -static_cast<int>(C.rows());
  for (std::size_t k = 0; k < problem.captures.size(); ++k) {
    const StaticNormal::Body& body = normal.bodies[k];
    const Vector6d e = BodyResidual(problem, state, k);
    const Matrix6d weight = problem.captures[k].covariance.inverse(), J = RightJacobianInverse(e);
    // What of the body's pose is still free once it has been fitted.
    const Eigen::MatrixXd total = J * body.inverse * body.mixed;
    const Matrix6d C_e = total * C * total.transpose() + J * body.inverse * J.transpose();
    for (const int part : {0, 1}) {
      const Eigen::Matrix3d W = weight.block<3, 3>(3 * part, 3 * part);
      const Eigen::Vector3d e_part = e.segment<3>(3 * part);
      fit.squares[part] += e_part.dot(W * e_part);
      fit.redundancy[part] += 3 - (W * C_e.block<3, 3>(3 * part, 3 * part)).trace();
    }
    fit.chi2 += e.dot(weight * e);
    for (const PlaneSighting& seen : problem.captures[k].seen) {
      const Vector7d g =
          PlaneInLidar(state.T_world_body[k], state.T_body_lidar, state.planes[seen.plane_idx], problem.range_bias_m);
      fit.chi2 += std::max(0.0, g.dot(seen.moments.sum * g) - LeastSquares(seen.moments));
      fit.dof += 3;
    }
  }
  return fit;
}

}  // namespace rigcal::calib
