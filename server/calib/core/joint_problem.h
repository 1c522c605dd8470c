// The joint least-squares problem of a camera pair as plain values: what was seen, what is estimated, and its minimum.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "server/base/result.h"
#include "server/calib/camera/given_intrinsics.h"
#include "server/calib/camera/projection.h"
#include "server/calib/camera/seen_corners.h"
#include "server/math/se3.h"

namespace rigcal::calib {

// One capture; empty: that camera did not see the board. The two may be different parts of the board. A capture that
// only one camera saw has a board pose of its own, so it informs that camera's intrinsics and nothing else.
struct JointCapture {
  SeenCorners a, b;
};

struct JointCamera {
  CameraModel model = CameraModel::kPinholeRadtan;
  bool estimate = true;   // intrinsics; otherwise they stay as the state gives them
  std::vector<int> held;  // of the estimated intrinsics, by index: stay as the state gives them
  IntrinsicsPull pull;    // of the estimated intrinsics: what is known of them beforehand
  [[nodiscard]] bool IsFree() const { return estimate && !pull.Pulls(); }  // by the views alone
};

struct JointProblem {
  std::vector<Eigen::Vector3d> corners_board;
  std::vector<JointCapture> captures;
  JointCamera a, b;
};

struct JointState {
  IntrinsicsVector intrinsics_a = IntrinsicsVector::Zero(), intrinsics_b = IntrinsicsVector::Zero();
  Se3 T_a_b;
  std::vector<Se3> T_a_board;  // one per capture
};

struct JointSolution {
  JointState state;
  int iterations = 0;
};

// Sum of squared residuals of one capture per camera, in px^2. Infinite where the camera cannot see a corner.
struct CaptureError {
  double a_px2 = 0, b_px2 = 0;
};

// Levenberg-Marquardt over everything at once (Ceres, dense Schur complement, one thread: deterministic).
// Fails if the start is not feasible or the minimum is not reached. Done where a step loses less than `settled_ratio`
// of the sum of squares, by default far below the noise: what remains of the start must not show in the jackknife's
// small differences.
[[nodiscard]] Result<JointSolution> SolveJoint(const JointProblem& problem, const JointState& start,
                                               double settled_ratio = 1e-15);
// A step that loses less leaves some 1e-6 sigma: enough where a problem that differs little is solved again, or a start
// is chosen.
constexpr double kSettledAgain_ratio = 1e-12;
// The same over the pose of one capture's board alone, all else held; infeasible starts come back unchanged.
[[nodiscard]] Se3 SolveBoardPose(const JointProblem& problem, const JointState& state, std::size_t capture_idx,
                                 const Se3& T_a_board);
[[nodiscard]] CaptureError ErrorOf(const JointProblem& problem, const JointState& state, std::size_t capture_idx);
// Of both cameras, over all captures.
[[nodiscard]] double SumOfSquares_px2(const JointProblem& problem, const JointState& state);
// Numbers (two per corner and view) and free parameters of the whole problem, less those that a pull tells already.
[[nodiscard]] int ResidualCount(const JointProblem& problem);
[[nodiscard]] int ParameterCount(const JointProblem& problem);

}  // namespace rigcal::calib
