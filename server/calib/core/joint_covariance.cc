#include "server/calib/core/joint_covariance.h"

#include <ceres/cost_function.h>

#include <Eigen/Eigenvalues>
#include <cmath>

#include "server/calib/core/costs.h"
#include "server/calib/core/pose_block.h"
#include "server/math/covariance.h"

namespace rigcal::calib {
namespace {

// After scaling to a unit diagonal the worst direction of a usable pair is at 1e-6 or above; rounding is at 1e-14.
constexpr double kSmallestEigenvalue = 1e-11;

using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
using SharedToBoard = Eigen::Matrix<double, kReducedSize, 6>;

tl::unexpected<Error> NotObservable(const std::string& what) {
  return Fail(ErrorCode::kInvalidInput, what, "Take more captures with the board tilted in different directions.");
}

// The normal matrix of one capture: shared parameters, its board, and the corner between.
struct CaptureNormal {
  ReducedMatrix shared = ReducedMatrix::Zero();
  SharedToBoard mixed = SharedToBoard::Zero();
  Matrix6d board = Matrix6d::Zero();

  // `starts` and `jacobians` of the shared blocks of one view; the last Jacobian is the board's.
  void Add(const std::vector<int>& starts, const std::vector<RowMajor>& jacobians) {
    const RowMajor& board_jacobian = jacobians.back();
    board += board_jacobian.transpose() * board_jacobian;
    for (std::size_t i = 0; i < starts.size(); ++i) {
      mixed.middleRows(starts[i], jacobians[i].cols()) += jacobians[i].transpose() * board_jacobian;
      for (std::size_t j = 0; j < starts.size(); ++j)
        shared.block(starts[i], starts[j], jacobians[i].cols(), jacobians[j].cols()) +=
            jacobians[i].transpose() * jacobians[j];
    }
  }
};

// Jacobians of one view by its blocks as Ceres sees them; empty if the view is not feasible.
std::vector<RowMajor> BlockJacobians(const ceres::CostFunction& cost, const std::vector<const double*>& blocks) {
  std::vector<RowMajor> jacobians;
  std::vector<double*> pointers;
  for (const int size : cost.parameter_block_sizes()) jacobians.emplace_back(cost.num_residuals(), size);
  for (RowMajor& jacobian : jacobians) pointers.push_back(jacobian.data());
  Eigen::VectorXd residuals(cost.num_residuals());
  if (!cost.Evaluate(blocks.data(), residuals.data(), pointers.data())) return {};
  return jacobians;
}

void HoldColumns(const JointCamera& camera, RowMajor& d_intrinsics) {
  if (!camera.estimate) d_intrinsics.setZero();
  for (const int i : camera.held) d_intrinsics.col(i).setZero();
}

bool AddReferenceView(const JointProblem& problem, const JointState& state, std::size_t k, CaptureNormal& normal) {
  const PoseBlock T_a_board = BlockOf(state.T_a_board[k]);
  auto jacobians = BlockJacobians(*MakeReferenceViewCost(problem.a.model, problem.corners_board, problem.captures[k].a),
                                  {state.intrinsics_a.data(), T_a_board.data()});
  if (jacobians.empty()) return false;
  HoldColumns(problem.a, jacobians[0]);
  jacobians[1] = jacobians[1] * PlusJacobian(state.T_a_board[k]);
  normal.Add({kIntrinsicsAStart}, jacobians);
  return true;
}

bool AddSecondView(const JointProblem& problem, const JointState& state, std::size_t k, CaptureNormal& normal) {
  const PoseBlock T_a_b = BlockOf(state.T_a_b), T_a_board = BlockOf(state.T_a_board[k]);
  auto jacobians = BlockJacobians(*MakeSecondViewCost(problem.b.model, problem.corners_board, problem.captures[k].b),
                                  {state.intrinsics_b.data(), T_a_b.data(), T_a_board.data()});
  if (jacobians.empty()) return false;
  HoldColumns(problem.b, jacobians[0]);
  jacobians[1] = jacobians[1] * PlusJacobian(state.T_a_b);
  jacobians[2] = jacobians[2] * PlusJacobian(state.T_a_board[k]);
  normal.Add({kIntrinsicsBStart, kPairStart}, jacobians);
  return true;
}

// Inverse through the eigenvalues of the matrix scaled to a unit diagonal; empty if one of them is too small.
Eigen::MatrixXd ScaledInverse(const Eigen::MatrixXd& matrix) {
  if (!matrix.allFinite() || !(matrix.diagonal().minCoeff() > 0)) return {};
  const Eigen::VectorXd scale = matrix.diagonal().cwiseSqrt().cwiseInverse();
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(scale.asDiagonal() * matrix * scale.asDiagonal());
  if (solver.info() != Eigen::Success || !(solver.eigenvalues().minCoeff() > kSmallestEigenvalue)) return {};
  const Eigen::MatrixXd scaled_inverse =
      solver.eigenvectors() * solver.eigenvalues().cwiseInverse().asDiagonal() * solver.eigenvectors().transpose();
  return scale.asDiagonal() * scaled_inverse * scale.asDiagonal();
}

// What pulls tell, on the diagonal.
ReducedMatrix PullsOf(const JointProblem& problem) {
  ReducedMatrix pulls = ReducedMatrix::Zero();
  for (int i = 0; i < kIntrinsicsMax; ++i) {
    if (problem.a.estimate) pulls(kIntrinsicsAStart + i, kIntrinsicsAStart + i) = std::pow(problem.a.pull.Weight(i), 2);
    if (problem.b.estimate) pulls(kIntrinsicsBStart + i, kIntrinsicsBStart + i) = std::pow(problem.b.pull.Weight(i), 2);
  }
  return pulls;
}

// What one sigma of each pulled number does to T_a_b.
std::vector<Vector6d> ShiftsOf(const ReducedMatrix& inverse, int start, const IntrinsicsPull& pull) {
  std::vector<Vector6d> shifts;
  for (int i = 0; i < kIntrinsicsMax; ++i)
    if (pull.Pulls() && pull.sigma[i] > 0)
      shifts.push_back(inverse.block<6, 1>(kPairStart, start + i) * pull.Weight(i) * pull.corner_sigma_px);
  return shifts;
}

Result<CaptureNormal> NormalOf(const JointProblem& problem, const JointState& state, std::size_t k) {
  CaptureNormal normal;
  const bool a_ok = problem.captures[k].a.empty() || AddReferenceView(problem, state, k, normal);
  const bool b_ok = problem.captures[k].b.empty() || AddSecondView(problem, state, k, normal);
  if (!a_ok || !b_ok) return NotObservable("a board lies where its camera cannot see");
  return normal;
}

}  // namespace

Result<Matrix6d> BoardInformation(const JointProblem& problem, const JointState& state, std::size_t k) {
  RIGCAL_ASSIGN(const CaptureNormal normal, NormalOf(problem, state, k));
  if (ScaledInverse(normal.board).size() == 0) return NotObservable("the pose of a board is not determined");
  return Matrix6d(0.5 * (normal.board + normal.board.transpose()));
}

Result<ReducedMatrix> ReducedNormal(const JointProblem& problem, const JointState& state) {
  ReducedMatrix reduced = ReducedMatrix::Zero();
  for (std::size_t k = 0; k < problem.captures.size(); ++k) {
    RIGCAL_ASSIGN(const CaptureNormal normal, NormalOf(problem, state, k));
    const Eigen::MatrixXd board_inverse = ScaledInverse(normal.board);
    if (board_inverse.size() == 0) return NotObservable("the pose of a board is not determined");
    reduced += normal.shared - normal.mixed * board_inverse * normal.mixed.transpose();
  }
  return ReducedMatrix(0.5 * (reduced + reduced.transpose()));
}

Result<ReducedMatrix> InverseOfFree(const ReducedMatrix& normal) {
  std::vector<int> free;
  for (int i = 0; i < kReducedSize; ++i)
    if (!normal.row(i).isZero(0)) free.push_back(i);
  const Eigen::MatrixXd part = normal(free, free);
  const Eigen::MatrixXd part_inverse = ScaledInverse(part);
  if (part_inverse.size() == 0)
    return NotObservable("the captures leave a direction of the pair or its intrinsics open");
  ReducedMatrix inverse = ReducedMatrix::Zero();
  inverse(free, free) = part_inverse;
  return inverse;
}

Result<JointCovariance> ModelCovariance(const JointProblem& problem, const JointState& state) {
  const int dof = ResidualCount(problem) - ParameterCount(problem);
  if (dof <= 0) return NotObservable("there are fewer corners than unknowns");
  RIGCAL_ASSIGN(const ReducedMatrix normal, ReducedNormal(problem, state));
  const ReducedMatrix pulls = PullsOf(problem);
  RIGCAL_ASSIGN(const ReducedMatrix inverse, InverseOfFree(normal + pulls));
  return JointCovariance{SumOfSquares_px2(problem, state) / dof * (inverse - inverse * pulls * inverse),
                         ShiftsOf(inverse, kIntrinsicsAStart, problem.a.pull),
                         ShiftsOf(inverse, kIntrinsicsBStart, problem.b.pull)};
}

}  // namespace rigcal::calib
