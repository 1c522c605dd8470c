// What the joint problem knows about the pair, from its normal matrix.
#pragma once

#include <Eigen/Core>

#include "server/calib/joint_problem.h"

namespace rigcal::calib {

// Blocks of the reduced normal matrix: T_a_b (right tangent at b), then the intrinsics that are estimated.
constexpr int kReducedSize = 6 + 2 * kIntrinsicsCount;
constexpr int kPairStart = 0, kIntrinsicsAStart = 6, kIntrinsicsBStart = 6 + kIntrinsicsCount;
using ReducedMatrix = Eigen::Matrix<double, kReducedSize, kReducedSize>;

// J^T J with the board poses eliminated (Schur complement), at `state`, for residuals in px of unit sigma. Rows of what
// is held are zero. Fails if a corner is not in front of its camera or a board's pose is not determined.
[[nodiscard]] Result<ReducedMatrix> ReducedNormal(const JointProblem& problem, const JointState& state);
// Inverse of the rows and columns start ... start + size - 1 after elimination of all other free ones among `free_blocks`;
// see ModelCovariance for the usual case. Fails, naming no sensor, where a direction is not observable.
[[nodiscard]] Result<Eigen::MatrixXd> FreeCovariance(const ReducedMatrix& normal, bool pair, bool a, bool b);

struct ModelCovariance {
  double s2_px2 = 0;                       // variance of a residual: SSR / (residuals - parameters)
  Matrix6d pair = Matrix6d::Zero();        // s^2 H^-1, block of T_a_b
  double fx_a_sigma_px = 0, fx_b_sigma_px = 0;  // 0 where given
};
[[nodiscard]] Result<ModelCovariance> CovarianceOf(const JointProblem& problem, const JointState& state);

}  // namespace rigcal::calib
