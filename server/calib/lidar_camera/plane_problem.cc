#include "server/calib/lidar_camera/plane_problem.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <cmath>

namespace rigcal::calib {
namespace {

constexpr int kIterationsMax = 100, kHalvingsMax = 20;
constexpr double kStepTolerance = 1e-12;     // metres and radians
constexpr double kHeldStepTolerance = 1e-6;  // likewise, where a direction is held: it settles slowly
// Square of a step in sigmas: what less gains is lost in the rounding of the cost, a difference of large moments.
constexpr double kStepTolerance_sigmas2 = 1e-14;
// Of the information matrix scaled to a unit diagonal.
constexpr double kSmallestEigenvalue = 1e-10;
constexpr double kHeldSigma_m = 0.1;  // of what is held where a drawing has it

using Jacobian7x7 = Eigen::Matrix<double, 7, 7>;
using Jacobian7x6 = Eigen::Matrix<double, 7, 6>;

struct Linearized {
  Vector7d g;
  Jacobian7x7 by_shared = Jacobian7x7::Zero();  // [xi, bias]
  Jacobian7x6 by_board = Jacobian7x6::Zero();
};

// T_cam_lidar Exp([v, w]) moves the plane (a, c) = (R^T n, n . t - d) by da = a x w, dc = a . v; T_cam_board Exp([v,
// w]) by dn = -R_cam_board (w x e_z), dd = dn . p + n . R_cam_board v.
Linearized LinearizeAt(const PlaneState& state, std::size_t k) {
  Linearized result;
  result.g = PlaneInLidar(state, k);
  const double b_m = state.range_bias_m;
  const Eigen::Vector3d a = result.g.head<3>();
  result.by_shared.block<3, 3>(0, 3) = Hat(a);
  result.by_shared.block<3, 3>(3, 3) = b_m * Hat(a);
  result.by_shared.block<1, 3>(6, 0) = a.transpose();
  result.by_shared.block<3, 1>(3, 6) = a;
  const Eigen::Matrix3d R_cam_lidar = state.T_cam_lidar.R(), R_cam_board = state.T_cam_board[k].R();
  const Eigen::Matrix3d dn = R_cam_board * Hat(Eigen::Vector3d::UnitZ());
  const Eigen::Vector3d n = -R_cam_board.col(2), lever_m = state.T_cam_lidar.p_m - state.T_cam_board[k].p_m;
  result.by_board.block<3, 3>(0, 3) = R_cam_lidar.transpose() * dn;
  result.by_board.block<3, 3>(3, 3) = b_m * R_cam_lidar.transpose() * dn;
  result.by_board.block<1, 3>(6, 3) = lever_m.transpose() * dn;
  result.by_board.block<1, 3>(6, 0) = -n.transpose() * R_cam_board;
  return result;
}

double OffHeld_m(const PlaneState& state) {
  return state.held ? state.held->axis_cam.dot(state.T_cam_lidar.p_m) - state.held->at_m : 0.0;
}

// T_cam_lidar Exp([v, w]) moves the lidar by R v.
Vector7d ByHeld(const PlaneState& state) {
  Vector7d by = Vector7d::Zero();
  by.head<3>() = state.T_cam_lidar.R().transpose() * state.held->axis_cam / kHeldSigma_m;
  return by;
}

void AddHeld(const PlaneState& state, Matrix7d& H, Vector7d& gradient) {
  if (!state.held) return;
  const Vector7d by = ByHeld(state);
  H += by * by.transpose();
  gradient += by * OffHeld_m(state) / kHeldSigma_m;
}

double CostOf(const std::vector<PlaneCapture>& captures, const PlaneState& state) {
  double cost = std::pow(OffHeld_m(state) / kHeldSigma_m, 2);
  for (std::size_t k = 0; k < captures.size(); ++k) {
    const Vector7d g = PlaneInLidar(state, k);
    const Vector6d delta = (captures[k].T_cam_board.Inverse() * state.T_cam_board[k]).Log();
    cost += captures[k].factor * g.dot(captures[k].moments.sum * g) + delta.dot(captures[k].camera_information * delta);
  }
  return cost;
}

// Normal equations of one capture, and what eliminating its board needs.
struct CaptureNormal {
  Matrix7d shared;
  Vector7d gradient;
  Eigen::Matrix<double, 6, 7> board_by_shared;  // H_dd^-1 H_dx
  Vector6d board_step;                          // H_dd^-1 g_d
  double board_loss = 0.0;                      // of the cost by that step: g_d^T H_dd^-1 g_d
};

CaptureNormal NormalOf(const PlaneCapture& capture, const PlaneState& state, std::size_t k) {
  const Linearized at = LinearizeAt(state, k);
  const Matrix7d M = capture.factor * capture.moments.sum;
  const Vector6d delta = (capture.T_cam_board.Inverse() * state.T_cam_board[k]).Log();
  const Matrix6d J = RightJacobianInverse(delta);
  const Matrix6d board = at.by_board.transpose() * M * at.by_board + J.transpose() * capture.camera_information * J;
  const Eigen::Matrix<double, 6, 7> mixed = at.by_board.transpose() * M * at.by_shared;
  const Vector6d board_gradient =
      at.by_board.transpose() * M * at.g + J.transpose() * capture.camera_information * delta;
  const Eigen::LDLT<Matrix6d> factored(board);
  CaptureNormal normal;
  normal.board_by_shared = factored.solve(mixed);
  normal.board_step = factored.solve(board_gradient);
  normal.board_loss = board_gradient.dot(normal.board_step);
  normal.shared = at.by_shared.transpose() * M * at.by_shared - mixed.transpose() * normal.board_by_shared;
  normal.gradient = at.by_shared.transpose() * M * at.g - mixed.transpose() * normal.board_step;
  return normal;
}

// The step that solves the normal equations in the first `size` parameters; nothing where a direction is open.
Result<Vector7d> StepOf(const Matrix7d& H, const Vector7d& gradient, int size) {
  const auto open = [] {
    return Fail(ErrorCode::kInvalidInput, "the boards leave a direction of the pose open",
                "Take more captures with the board tilted in different directions.");
  };
  const Eigen::MatrixXd part = H.topLeftCorner(size, size);
  if (!part.allFinite() || !(part.diagonal().minCoeff() > 0)) return open();
  const Eigen::VectorXd scale = part.diagonal().cwiseSqrt().cwiseInverse();
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(scale.asDiagonal() * part * scale.asDiagonal());
  if (!(solver.eigenvalues().minCoeff() > kSmallestEigenvalue)) return open();
  Vector7d step = Vector7d::Zero();
  step.head(size) = -(scale.asDiagonal() * solver.eigenvectors() * solver.eigenvalues().cwiseInverse().asDiagonal() *
                      solver.eigenvectors().transpose() * scale.asDiagonal() * gradient.head(size));
  return step;
}

PlaneState Moved(const PlaneState& state, const std::vector<CaptureNormal>& normals, const Vector7d& step,
                 double length) {
  PlaneState moved = state;
  moved.T_cam_lidar = (state.T_cam_lidar * Se3::Exp(length * step.head<6>())).Normalized();
  moved.range_bias_m += length * step[6];
  for (std::size_t k = 0; k < normals.size(); ++k) {
    const Vector6d board = -(normals[k].board_step + normals[k].board_by_shared * step);
    moved.T_cam_board[k] = (state.T_cam_board[k] * Se3::Exp(length * board)).Normalized();
  }
  return moved;
}

}  // namespace

// The minimum of x^T H x / 2 + (by . x - c)^2 / 2 moves along (H + by by^T)^-1 by with c, and so along H^-1 by.
Vector6d FollowingHeld(const PlaneSolution& solution) {
  const Matrix6d information = solution.information.topLeftCorner<6, 6>();
  return information.ldlt().solve(ByHeld(solution.state).head<6>());
}

Vector7d PlaneInLidar(const PlaneState& state, std::size_t capture_idx) {
  const Se3& T_cam_board = state.T_cam_board[capture_idx];
  const Eigen::Vector3d n_cam = -T_cam_board.R().col(2);
  const Eigen::Vector3d n_lidar = state.T_cam_lidar.R().transpose() * n_cam;
  Vector7d g;
  g << n_lidar, state.range_bias_m * n_lidar, n_cam.dot(state.T_cam_lidar.p_m - T_cam_board.p_m);
  return g;
}

double MeanDistance_m(const PlaneCapture& capture, const Vector7d& g) {
  return -capture.moments.sum.row(6).dot(g) / capture.moments.weight_per_m2;
}

double MeanDistanceSigma_m(const PlaneCapture& capture, const PlaneState& state, std::size_t capture_idx) {
  const double weight_per_m2 = capture.moments.weight_per_m2;
  const Vector6d by_board =
      (capture.moments.sum.row(6) * LinearizeAt(state, capture_idx).by_board).transpose() / weight_per_m2;
  return std::sqrt(1 / weight_per_m2 + by_board.dot(capture.camera_information.ldlt().solve(by_board)));
}

Result<PlaneSolution> SolvePlanes(const std::vector<PlaneCapture>& captures, const PlaneState& start,
                                  bool estimate_bias, double linear_ratio) {
  PlaneSolution solution{start, Matrix7d::Zero(), 0.0, 0};
  const int size = estimate_bias ? 7 : 6;
  double cost = CostOf(captures, start);
  for (; solution.iterations < kIterationsMax; ++solution.iterations) {
    std::vector<CaptureNormal> normals;
    Matrix7d H = Matrix7d::Zero();
    Vector7d gradient = Vector7d::Zero();
    double loss = 0.0;  // as far as residuals are linear
    for (std::size_t k = 0; k < captures.size(); ++k) {
      normals.push_back(NormalOf(captures[k], solution.state, k));
      H += normals[k].shared;
      gradient += normals[k].gradient;
      loss += normals[k].board_loss;
    }
    AddHeld(solution.state, H, gradient);
    RIGCAL_ASSIGN(const Vector7d step, StepOf(H, gradient, size));
    const double shared_loss = -gradient.dot(step);
    solution.information.setZero();
    solution.information.topLeftCorner(size, size) = H.topLeftCorner(size, size);
    solution.cost = cost;
    if (step.norm() < (start.held ? kHeldStepTolerance : kStepTolerance) || step.dot(H * step) < kStepTolerance_sigmas2)
      return solution;
    double length = 1;
    PlaneState moved = Moved(solution.state, normals, step, length);
    double moved_cost = CostOf(captures, moved);
    for (int halving = 0; halving < kHalvingsMax && !(moved_cost <= cost); ++halving) {
      length /= 2;
      moved = Moved(solution.state, normals, step, length);
      moved_cost = CostOf(captures, moved);
    }
    if (!(moved_cost < cost)) return solution;  // as deep as rounding lets it see
    const bool is_linear = length == 1 && std::abs(cost - moved_cost - loss - shared_loss) < linear_ratio * shared_loss;
    solution.state = std::move(moved);
    solution.cost = cost = moved_cost;
    if (is_linear) return solution;
  }
  return Fail(ErrorCode::kInvalidInput, "the refinement of the pose did not converge",
              "Check that pictures and clouds belong together and take more captures.");
}

}  // namespace rigcal::calib
