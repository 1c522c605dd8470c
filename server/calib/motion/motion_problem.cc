#include "server/calib/motion/motion_problem.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "server/math/covariance.h"

namespace rigcal::calib {
namespace {

constexpr int kGlobalMax = 12 + 2 * kSharedMax;
using GlobalMatrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, kGlobalMax, kGlobalMax>;
using GlobalVector = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, kGlobalMax, 1>;
using GlobalRows = Eigen::Matrix<double, 6, Eigen::Dynamic, 0, 6, kGlobalMax>;

constexpr int kDampingsMax = 12;
constexpr double kStepSmall = 1e-10;           // m, rad, and shared parameters over their sigma
constexpr double kEigenvalueSmallest = 1e-11;  // after scaling to a unit diagonal
constexpr double kCostNoise = 1e-13;

// Where the parts of the global step stand: X, Z, shared of a, shared of b.
struct Layout {
  int x, z, a, b, size;
  explicit Layout(const MotionProblem& problem)
      : x(0),
        z(static_cast<int>(problem.free.cols())),
        a(z + 6),
        b(a + problem.a.SharedCount()),
        size(b + problem.b.SharedCount()) {}
};

Se3 Moved(const SidePose& pose, const SharedVector& shared) {
  return shared.size() == 0 ? pose.T_world_sensor : pose.T_world_sensor * Se3::Exp(pose.d_shared * shared);
}

struct SideRow {
  Vector6d e;         // Log(measured^-1 estimated)
  GlobalRows global;  // its derivatives
  Matrix6d body;      // by the body's pose
  Matrix6d weight;
};

SideRow RowOfA(const MotionProblem& problem, const MotionState& state, std::size_t k, const Layout& at) {
  const SidePose& pose = problem.a.poses[k];
  const Se3 E = Moved(pose, state.shared_a).Inverse() * state.T_world_a[k];
  SideRow row{E.Log(), GlobalRows::Zero(6, at.size), {}, pose.covariance.inverse()};
  row.body = RightJacobianInverse(row.e);
  if (problem.a.SharedCount() > 0)
    row.global.middleCols(at.a, problem.a.SharedCount()) = -row.body * Adjoint(E.Inverse()) * pose.d_shared;
  return row;
}

SideRow RowOfB(const MotionProblem& problem, const MotionState& state, std::size_t k, const Layout& at) {
  const SidePose& pose = problem.b.poses[k];
  const Se3 T_world_b = state.Z.Inverse() * state.T_world_a[k] * state.X;
  const Se3 E = Moved(pose, state.shared_b).Inverse() * T_world_b;
  SideRow row{E.Log(), GlobalRows::Zero(6, at.size), {}, pose.covariance.inverse()};
  const Matrix6d J = RightJacobianInverse(row.e);
  row.body = J * Adjoint(state.X.Inverse());
  row.global.leftCols(at.z) = J * problem.free;
  row.global.middleCols<6>(at.z) = -J * Adjoint(T_world_b.Inverse());
  if (problem.b.SharedCount() > 0)
    row.global.middleCols(at.b, problem.b.SharedCount()) = -J * Adjoint(E.Inverse()) * pose.d_shared;
  return row;
}

double PriorCost(const MotionSide& side, const SharedVector& shared) {
  return shared.size() == 0 ? 0.0 : shared.dot(side.information * shared) + 2 * side.gradient.dot(shared);
}

double CostOf(const MotionProblem& problem, const MotionState& state) {
  double cost = PriorCost(problem.a, state.shared_a) + PriorCost(problem.b, state.shared_b);
  for (std::size_t k = 0; k < problem.used.size(); ++k) {
    if (!problem.used[k]) continue;
    const Vector6d e_a = (Moved(problem.a.poses[k], state.shared_a).Inverse() * state.T_world_a[k]).Log();
    const Vector6d e_b =
        (Moved(problem.b.poses[k], state.shared_b).Inverse() * state.Z.Inverse() * state.T_world_a[k] * state.X).Log();
    cost += e_a.dot(problem.a.poses[k].covariance.llt().solve(e_a)) +
            e_b.dot(problem.b.poses[k].covariance.llt().solve(e_b));
  }
  return cost;
}

// Normal equations of one pose: the body's part, and what couples it to the global part.
struct BodyNormal {
  SideRow a, b;
  Matrix6d inverse = Matrix6d::Zero();  // of the body's own normal matrix
  GlobalRows mixed;                     // body x global
  Vector6d gradient;
};

BodyNormal NormalOf(const MotionProblem& problem, const MotionState& state, std::size_t k, const Layout& at) {
  BodyNormal normal{RowOfA(problem, state, k, at), RowOfB(problem, state, k, at), {}, {}, {}};
  const Matrix6d a = normal.a.body.transpose() * normal.a.weight, b = normal.b.body.transpose() * normal.b.weight;
  normal.inverse = (a * normal.a.body + b * normal.b.body).inverse();
  normal.mixed = a * normal.a.global + b * normal.b.global;
  normal.gradient = a * normal.a.e + b * normal.b.e;
  return normal;
}

struct Reduced {
  GlobalMatrix H;
  GlobalVector g;
  std::vector<BodyNormal> bodies;  // of the used poses

  // Of the cost, by an undamped step of all unknowns, as far as residuals are linear.
  [[nodiscard]] double LossBy(const GlobalVector& step) const {
    double loss = -g.dot(step);
    for (const BodyNormal& body : bodies) loss += body.gradient.dot(body.inverse * body.gradient);
    return loss;
  }
};

Reduced Reduce(const MotionProblem& problem, const MotionState& state, const Layout& at) {
  Reduced reduced{GlobalMatrix::Zero(at.size, at.size), GlobalVector::Zero(at.size), {}};
  const auto add_prior = [&](const MotionSide& side, const SharedVector& shared, int start) {
    if (shared.size() == 0) return;
    reduced.H.block(start, start, shared.size(), shared.size()) += side.information;
    reduced.g.segment(start, shared.size()) += side.information * shared + side.gradient;
  };
  add_prior(problem.a, state.shared_a, at.a);
  add_prior(problem.b, state.shared_b, at.b);
  for (std::size_t k = 0; k < problem.used.size(); ++k) {
    if (!problem.used[k]) continue;
    BodyNormal n = NormalOf(problem, state, k, at);
    reduced.H += n.a.global.transpose() * n.a.weight * n.a.global + n.b.global.transpose() * n.b.weight * n.b.global -
                 n.mixed.transpose() * n.inverse * n.mixed;
    reduced.g += n.a.global.transpose() * (n.a.weight * n.a.e) + n.b.global.transpose() * (n.b.weight * n.b.e) -
                 n.mixed.transpose() * (n.inverse * n.gradient);
    reduced.bodies.push_back(std::move(n));
  }
  return reduced;
}

GlobalVector StepOf(const Reduced& reduced, double damping) {
  const GlobalVector scale = UnitDiagonal(reduced.H);
  const GlobalMatrix scaled = scale.asDiagonal() * reduced.H * scale.asDiagonal();
  const Eigen::SelfAdjointEigenSolver<GlobalMatrix> solver(0.5 * (scaled + scaled.transpose()));
  GlobalVector along = solver.eigenvectors().transpose() * (scale.asDiagonal() * reduced.g);
  for (Eigen::Index i = 0; i < along.size(); ++i) {
    const double value = solver.eigenvalues()[i];
    along[i] = value > kEigenvalueSmallest ? -along[i] / (value + damping) : 0.0;
  }
  return scale.asDiagonal() * (solver.eigenvectors() * along);
}

MotionState Stepped(const MotionProblem& problem, const MotionState& state, const Reduced& reduced,
                    const GlobalVector& step, const Layout& at) {
  MotionState next = state;
  next.X = (state.X * Se3::Exp(problem.free * step.head(at.z))).Normalized();
  next.Z = (state.Z * Se3::Exp(step.segment<6>(at.z))).Normalized();
  next.shared_a += step.segment(at.a, problem.a.SharedCount());
  next.shared_b += step.segment(at.b, problem.b.SharedCount());
  std::size_t body = 0;
  for (std::size_t k = 0; k < problem.used.size(); ++k) {
    if (!problem.used[k]) continue;
    const BodyNormal& n = reduced.bodies[body++];
    next.T_world_a[k] = (state.T_world_a[k] * Se3::Exp(-(n.inverse * (n.gradient + n.mixed * step)))).Normalized();
  }
  return next;
}

double SizeOf(const GlobalVector& step, const GlobalMatrix& H, const Layout& at) {
  double size = step.head(at.a).norm();
  for (int i = at.a; i < at.size; ++i) size += std::abs(step[i]) * std::sqrt(std::max(0.0, H(i, i))) * 1e-3;
  return size;
}

tl::unexpected<Error> NotConverged() {
  return Fail(ErrorCode::kInvalidInput, "the refinement of the two sensors' motion did not converge",
              "Check that both saw the same moments, and move and turn the robot more.");
}

}  // namespace

std::size_t MotionProblem::UsedCount() const {
  return static_cast<std::size_t>(std::count_if(used.begin(), used.end(), [](char u) { return u != 0; }));
}

MotionState StateFrom(const MotionProblem& problem, const Se3& X, const Se3& Z) {
  MotionState state{X, Z, SharedVector::Zero(problem.a.SharedCount()), SharedVector::Zero(problem.b.SharedCount()), {}};
  for (const SidePose& pose : problem.a.poses) state.T_world_a.push_back(pose.T_world_sensor);
  return state;
}

Vector6d MotionResidual(const MotionProblem& problem, const MotionState& state, std::size_t k) {
  const Se3 B = Moved(problem.b.poses[k], state.shared_b), A = Moved(problem.a.poses[k], state.shared_a);
  return ((state.Z * B).Inverse() * A * state.X).Log();
}

Matrix6d ResidualCovariance(const MotionProblem& problem, const Se3& X, std::size_t k) {
  const Matrix6d M = Adjoint(X.Inverse());
  return M * problem.a.poses[k].covariance * M.transpose() + problem.b.poses[k].covariance;
}

Result<MotionSolution> SolveMotion(const MotionProblem& problem, const MotionState& start, const MotionStop& stop) {
  const Layout at(problem);
  MotionSolution solution{start, CostOf(problem, start), 0};
  double damping = 0;
  for (; solution.iterations < stop.iterations_max; ++solution.iterations) {
    const Reduced reduced = Reduce(problem, solution.state, at);
    if (!reduced.H.allFinite() || !reduced.g.allFinite()) return NotConverged();
    int tries = 0;
    for (; tries < kDampingsMax; ++tries) {
      const GlobalVector step = StepOf(reduced, damping);
      MotionState next = Stepped(problem, solution.state, reduced, step, at);
      const double cost = CostOf(problem, next), size = SizeOf(step, reduced.H, at);
      if (cost <= solution.cost + kCostNoise * (1 + std::abs(solution.cost))) {
        const double loss = reduced.LossBy(step);
        const bool is_linear = damping == 0 && std::abs(solution.cost - cost - loss) < stop.linear_ratio * loss;
        solution.state = std::move(next);
        solution.cost = cost;
        damping *= 0.1;
        if (damping < 1e-9) damping = 0;
        if (size < kStepSmall || is_linear) return solution;
        break;
      }
      if (size < kStepSmall) return solution;
      damping = std::max(1e-6, 10 * damping);
    }
    if (tries == kDampingsMax) break;
  }
  // Along a direction that is hardly observed the steps shrink slowly; what they still gain is far below the noise.
  if (std::isfinite(solution.cost) && solution.iterations > 0) return solution;
  return NotConverged();
}

namespace {

// Adds the squares of one side's residual and what is expected of them. Of a side whose translation and rotation are
// not apart (not `split`) all of it is booked as translation.
void AddFit(const SideRow& row, const BodyNormal& n, const GlobalMatrix& C, bool split, SideFit& fit) {
  // d e / d global after the body's pose has followed, and what is left of the body's own freedom.
  const GlobalRows total = row.global - row.body * n.inverse * n.mixed;
  const Matrix6d C_e = total * C * total.transpose() + row.body * n.inverse * row.body.transpose();
  if (!split) {
    fit.squares[0] += row.e.dot(row.weight * row.e);
    fit.redundancy[0] += 6 - (row.weight * C_e).trace();
    return;
  }
  for (int part : {0, 1}) {
    const Eigen::Matrix3d weight = row.weight.block<3, 3>(3 * part, 3 * part);
    const Eigen::Vector3d e = row.e.segment<3>(3 * part);
    fit.squares[part] += e.dot(weight * e);
    fit.redundancy[part] += 3 - (weight * C_e.block<3, 3>(3 * part, 3 * part)).trace();
  }
}

bool IsSplit(const MotionSide& side) {
  return std::all_of(side.poses.begin(), side.poses.end(),
                     [](const SidePose& pose) { return pose.covariance.topRightCorner<3, 3>().isZero(0); });
}

}  // namespace

Result<MotionFit> FitOf(const MotionProblem& problem, const MotionState& state) {
  const Layout at(problem);
  const Reduced reduced = Reduce(problem, state, at);
  const GlobalVector scale = UnitDiagonal(reduced.H);
  const GlobalMatrix scaled = scale.asDiagonal() * reduced.H * scale.asDiagonal();
  const Eigen::SelfAdjointEigenSolver<GlobalMatrix> solver(0.5 * (scaled + scaled.transpose()));
  if (!reduced.H.allFinite() || !(solver.eigenvalues().minCoeff() > kEigenvalueSmallest))
    return Fail(ErrorCode::kInvalidInput, "the motion leaves a direction open",
                "Move and turn the robot about different axes.");
  const GlobalMatrix C = scale.asDiagonal() *
                         GlobalMatrix(solver.eigenvectors() * solver.eigenvalues().cwiseInverse().asDiagonal() *
                                      solver.eigenvectors().transpose()) *
                         scale.asDiagonal();
  MotionFit fit;
  fit.C_X = C.topLeftCorner(at.z, at.z);
  if (problem.a.SharedCount() > 0) fit.last_sigma_a = std::sqrt(C(at.b - 1, at.b - 1));
  if (problem.b.SharedCount() > 0) fit.last_sigma_b = std::sqrt(C(at.size - 1, at.size - 1));
  const bool split_a = IsSplit(problem.a), split_b = IsSplit(problem.b);
  for (const BodyNormal& n : reduced.bodies) {
    AddFit(n.a, n, C, split_a, fit.a);
    AddFit(n.b, n, C, split_b, fit.b);
  }
  return fit;
}

}  // namespace rigcal::calib
