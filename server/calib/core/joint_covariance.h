// What the joint problem knows about the pair, from its normal matrix.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "server/calib/core/joint_problem.h"

namespace rigcal::calib {

// Order of the reduced normal matrix: T_a_b (right tangent at b), intrinsics of a, intrinsics of b.
constexpr int kPairStart = 0, kIntrinsicsAStart = 6, kIntrinsicsBStart = kIntrinsicsAStart + kIntrinsicsMax;
constexpr int kReducedSize = kIntrinsicsBStart + kIntrinsicsMax;
using ReducedMatrix = Eigen::Matrix<double, kReducedSize, kReducedSize>;

// J^T J with the board poses eliminated (Schur complement), at `state`, for residuals in px of unit sigma. Rows and
// columns of what is held, or of a camera without views, are zero. Fails if a corner is not in front of its camera or
// a board's pose is not determined.
[[nodiscard]] Result<ReducedMatrix> ReducedNormal(const JointProblem& problem, const JointState& state);
// J^T J of T_a_board of one capture (right tangent at the board), all else held. Fails likewise.
[[nodiscard]] Result<Matrix6d> BoardInformation(const JointProblem& problem, const JointState& state, std::size_t k);
// Inverse of the rows and columns that are not zero; the others stay zero. Fails where a direction is not observable.
[[nodiscard]] Result<ReducedMatrix> InverseOfFree(const ReducedMatrix& normal);

struct JointCovariance {
  // s^2 H^-1 with s^2 = sum of squared residuals / (residuals - parameters); where intrinsics are pulled to what was
  // given, the part that the captures' errors bring: s^2 H^-1 N H^-1, N without the pulls.
  ReducedMatrix captures;
  // The other part: what one sigma of each pulled number does to T_a_b, ascending by index.
  std::vector<Vector6d> shifts_a, shifts_b;
};
// At the optimum. kInvalidInput where there are fewer residuals than unknowns, or a direction is open.
[[nodiscard]] Result<JointCovariance> ModelCovariance(const JointProblem& problem, const JointState& state);

}  // namespace rigcal::calib
