// Two sensors on one rigid body, each with its own poses in its own world: A_k X = Z B_k (paper, eq. 1, written for
// poses and not for motions: A_k = T_world-of-a_a, B_k = T_world-of-b_b, X = T_a_b, Z = T_world-of-a_world-of-b). The
// poses of the body are unknowns too, so that noise in a rotation is not mistaken for the rotation.
#pragma once

#include <vector>

#include "server/base/result.h"
#include "server/calib/core/directions.h"
#include "server/math/se3.h"

namespace rigcal::calib {

// What a side's poses share and what is estimated with them: a camera's intrinsics and the size of its board; how one
// stream's world drifts against the other's, and the offset of their clocks.
constexpr int kSharedMax = 14;
using SharedVector = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, kSharedMax, 1>;
using SharedMatrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, kSharedMax, kSharedMax>;
using SharedJacobian = Eigen::Matrix<double, 6, Eigen::Dynamic, 0, 6, kSharedMax>;

struct SidePose {
  Se3 T_world_sensor;                              // with the shared parameters at zero
  Matrix6d covariance = Matrix6d::Identity();      // of that, right tangent at the sensor
  SharedJacobian d_shared = SharedJacobian(6, 0);  // T_world_sensor * Exp(d_shared * shared)
};

struct MotionSide {
  std::vector<SidePose> poses;
  // What is known of the shared parameters apart from the motion: 1/2 s^T information s + gradient^T s.
  SharedMatrix information = SharedMatrix(0, 0);
  SharedVector gradient = SharedVector(0);
  // How many shared parameters this side has.
  [[nodiscard]] int SharedCount() const { return static_cast<int>(gradient.size()); }
};

// Poses of the two sides run side by side.
struct MotionProblem {
  MotionSide a, b;
  std::vector<char> used;  // a pose that is not used has no weight
  // Columns: directions of X (right tangent at b) along which it is estimated. All six unless the motion leaves some
  // open.
  Directions free = Matrix6d::Identity();
  // How many pairs of poses have weight.
  [[nodiscard]] std::size_t UsedCount() const;
};

// All unknowns. Perturbed on the right: X at b, Z at the world of b, the poses at a.
struct MotionState {
  Se3 X, Z;  // T_a_b; T_world-of-a_world-of-b
  SharedVector shared_a, shared_b;
  std::vector<Se3> T_world_a;  // the body's poses as both sides say
};

struct MotionSolution {
  MotionState state;
  double cost = 0.0;  // sum of the weighted squares of both sides and what is known of the shared parameters
  int iterations = 0;
};

constexpr int kMotionIterationsMax = 60;
struct MotionStop {
  int iterations_max = kMotionIterationsMax;  // with fewer it is on the way to the minimum
  // Done as well where an undamped step loses as many weighted squares as linear residuals would, to this part of them.
  double linear_ratio = 0.0;
};
// Gauss-Newton with damping where a step does not help; the body's poses eliminated. Deterministic. Directions of Z
// and of the shared parameters that nothing tells stay where they are. Fails if nothing converges.
[[nodiscard]] Result<MotionSolution> SolveMotion(const MotionProblem& problem, const MotionState& start,
                                                 const MotionStop& stop = {});
// A start from X and Z: the body where side a sees it, nothing shared.
[[nodiscard]] MotionState StateFrom(const MotionProblem& problem, const Se3& X, const Se3& Z);

// Log((Z B_k)^-1 A_k X): how far apart the two sides are, right tangent at b.
[[nodiscard]] Vector6d MotionResidual(const MotionProblem& problem, const MotionState& state, std::size_t k);
// Covariance of that: Ad(X^-1) C_A Ad(X^-1)^T + C_B.
[[nodiscard]] Matrix6d ResidualCovariance(const MotionProblem& problem, const Se3& X, std::size_t k);

// What the sides' own residuals say about their noise, split into translation and rotation.
struct SideFit {
  double squares[2] = {0, 0};     // weighted squares of the residuals
  double redundancy[2] = {0, 0};  // their expectation if the covariances are right
};
struct MotionFit {
  Eigen::MatrixXd C_X;                            // covariance of X along the free directions
  double last_sigma_a = 0.0, last_sigma_b = 0.0;  // of the last shared parameter of each side, if there is one
  SideFit a, b;
};
// Fails where a free direction is not observable.
[[nodiscard]] Result<MotionFit> FitOf(const MotionProblem& problem, const MotionState& state);

}  // namespace rigcal::calib
