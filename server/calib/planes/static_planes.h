// Planes that stand still in a world, seen by a lidar on a body whose poses in that world a tracker tells:
// T_body_lidar, the planes and the body's poses at once, so that noise in a pose is not mistaken for motion.
#pragma once

#include <vector>

#include "server/base/result.h"
#include "server/calib/core/directions.h"
#include "server/calib/planes/plane_moments.h"
#include "server/math/se3.h"

namespace rigcal::calib {

// n . p_world = d.
struct WorldPlane {
  Eigen::Vector3d normal = Eigen::Vector3d::UnitZ();  // unit
  double distance_m = 0.0;
};

struct PlaneSighting {
  std::size_t plane_idx = 0;
  PlaneMoments moments;  // of the points on it, lidar frame
};

struct StaticCapture {
  Se3 T_world_body;                            // as the tracker says
  Matrix6d covariance = Matrix6d::Identity();  // of that, right tangent at the body
  std::vector<PlaneSighting> seen;
};

struct StaticProblem {
  std::vector<StaticCapture> captures;
  double range_bias_m = 0.0;  // ranges are too short by this much
  // Orthonormal columns: directions of T_body_lidar (right tangent at the lidar) along which it is estimated.
  Directions free = Matrix6d::Identity();
};

struct StaticState {
  Se3 T_body_lidar;
  std::vector<WorldPlane> planes;
  std::vector<Se3> T_world_body;  // one per capture
};

struct StaticSolution {
  StaticState state;
  double cost = 0.0;  // at the minimum
  int iterations = 0;
};

constexpr int kStaticIterationsMax = 60;
// min sum g^T M g + delta^T covariance^-1 delta (Gauss-Newton with halved steps, the body's poses eliminated), g a
// plane in the lidar's frame (plane_moments.h). Directions that nothing tells stay where they are. Fails if nothing
// converges. With fewer iterations it is on the way to the minimum.
[[nodiscard]] Result<StaticSolution> SolveStatic(const StaticProblem& problem, const StaticState& start,
                                                 int iterations_max = kStaticIterationsMax);

// The plane of a sighting in the lidar's frame, as g, with the body where `T_world_body` says.
[[nodiscard]] Vector7d PlaneInLidar(const Se3& T_world_body, const Se3& T_body_lidar, const WorldPlane& plane,
                                    double range_bias_m);
// How g changes: with T_body_lidar and the body's pose (right tangents), with the plane (turned about two axes across
// its normal, moved along it).
struct SightingJacobian {
  Vector7d g;
  Eigen::Matrix<double, 7, 6> by_lidar, by_body;
  Eigen::Matrix<double, 7, 3> by_plane;
};
// Rows 3 to 5 of g are its normal times the range bias, and change with that normal.
[[nodiscard]] SightingJacobian JacobianAt(const Se3& T_world_body, const Se3& T_body_lidar, const WorldPlane& plane,
                                          double range_bias_m);

// Normal matrix of [T_body_lidar along `free`, planes], the body's poses eliminated; and what that needs per capture.
struct StaticNormal {
  Eigen::MatrixXd H;
  Eigen::VectorXd gradient;
  struct Body {
    Matrix6d inverse = Matrix6d::Zero();  // of the body's own normal matrix
    Eigen::MatrixXd mixed;                // body x global
    Vector6d gradient = Vector6d::Zero();
  };
  std::vector<Body> bodies;
};
// Of all captures, linearised at `state`.
[[nodiscard]] StaticNormal NormalOf(const StaticProblem& problem, const StaticState& state);

// What the residuals say of the tracker's noise and of the whole, translation before rotation.
struct StaticFit {
  Eigen::MatrixXd C_lidar;        // covariance of T_body_lidar along the free directions
  double squares[2] = {0, 0};     // of the tracker's poses
  double redundancy[2] = {0, 0};  // their expectation if its covariances are right
  double chi2 = 0.0;              // of everything, beyond the noise within the patches
  int dof = 0;
};
// Fails where a free direction is not observable.
[[nodiscard]] Result<StaticFit> FitOf(const StaticProblem& problem, const StaticState& state);

// plane_reach.cc: which directions of T_body_lidar a motion before static planes tells. What the poses' own noise would
// tell by itself does not count: from noisy poses information comes even where true ones give none. A pose that many
// sightings correct is less noisy than the tracker's.
//
// A direction counts if the change of the sightings that tells it is so many times what noise of the poses makes.
constexpr double kReachNoises = 3.0;

struct PlaneReach {
  // Orthonormal columns, right tangent at the lidar: what is open, and what is not.
  Directions open, free;
  double weakest_noises = 0.0;  // of the direction that is told least: its change over what noise makes
};
// `problem`: captures with the noise of their poses; its `free` is not used.
[[nodiscard]] PlaneReach ObservableByPlanes(const StaticProblem& problem, const StaticState& state);

// The open directions in words' terms, frame of the body: along which the position is not known whatever the rotation,
// and about which the rotation is not known.
struct OpenAxes {
  std::vector<Eigen::Vector3d> positions, turns;  // unit
};
// Of `reach.open`, which are right tangents at the lidar; an open direction that turns counts as a turn.
[[nodiscard]] OpenAxes AxesOf(const PlaneReach& reach, const Se3& T_body_lidar);

}  // namespace rigcal::calib
