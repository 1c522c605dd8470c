// One sensor's look at one board (or at its tracker) as normal equations: over a few unknowns of its own, and by the
// chain rule over those of the session.
#pragma once

#include <optional>

#include "server/calib/joint/problem/session_problem.h"

namespace rigcal::calib::joint {

// Columns of the session's vector that depend on the own unknowns: own = by * change.
struct Column {
  int at = kNone;
  Eigen::MatrixXd by;
};

// By how much a camera's look errs as a whole, xi ~ N(0, P^-1) the right tangent of the sensor at that capture: a loose
// mount, a picture of another moment. Eliminated from the look that it belongs to.
struct LookError {
  Vector6d xi = Vector6d::Zero(), information = Vector6d::Zero();  // P, diagonal
  double squares = 0.0;                                            // xi^T P xi
  double log_det = 0.0;                                            // of K^-1 P^-1, K^-1 its normal matrix
  double held = 0.0;                                               // tr(P K)
  Eigen::MatrixXd by_own;                                          // d xi = -by_own * d own
  Matrix6d by_pose = Matrix6d::Zero(), K = Matrix6d::Zero();       // d own pose / d xi; inverse of its normal matrix
  Vector6d b = Vector6d::Zero();                                   // its gradient, none at its optimum
};

// Normal matrix A = J^T W J and gradient b = J^T W r over the own unknowns, r = predicted - seen, weights included.
struct Observation {
  Eigen::MatrixXd A;
  Eigen::VectorXd b;
  double cost = 0.0;     // robust: what is minimised, times two
  double squares = 0.0;  // of residuals in sigmas, each by its robust weight
  double numbers = 0.0;  // residuals, likewise weighted
  std::vector<Column> columns;
  Eigen::MatrixXd by_place;                                   // own unknowns by the right tangent of the place
  Eigen::Vector2d squares_of_pose = Eigen::Vector2d::Zero();  // of a pose: of its translation, of its rotation
  std::optional<LookError> error;                             // of corners
};

// Nothing where a corner cannot be seen by the camera at this state. `weight` is that of the whole look.
[[nodiscard]] std::optional<Observation> Observe(const SessionProblem& problem, const Layout& layout,
                                                 const SessionState& state, const CornersSeen& seen,
                                                 const SensorNoise& noise, double weight);
[[nodiscard]] Observation Observe(const SessionProblem& problem, const Layout& layout, const SessionState& state,
                                  const PlateSeen& seen, const SensorNoise& noise, double weight);
[[nodiscard]] Observation Observe(const SessionProblem& problem, const Layout& layout, const SessionState& state,
                                  const PoseTold& told, const SensorNoise& noise, double weight);
// The same look with the coefficients of its camera's field as unknowns too: B, each pixel by them, is known from the
// pixel.
struct FieldLook {
  Observation plain;
  Eigen::MatrixXd own_field;  // J^T W B: own unknowns by coefficients
  Eigen::MatrixXd by_points;  // of B^T W B the half of u, which is that of v; nothing is between them
  Eigen::VectorXd b;          // B^T W r
  Eigen::MatrixXd by_error;   // what the look's error takes of B^T W B: by_error^T by_error; without rows: nothing
};
// Of a camera whose picture's size is known, over the control points `seen_points`, ascending.
[[nodiscard]] std::optional<FieldLook> ObserveWithField(const SessionProblem& problem, const Layout& layout,
                                                        const SessionState& state, const CornersSeen& seen,
                                                        const SensorNoise& noise, double weight,
                                                        const std::vector<int>& seen_points);
// Predicted less seen, px, of each corner, which all can be seen by the camera.
[[nodiscard]] std::vector<Eigen::Vector2d> CornerResiduals(const SessionProblem& problem, const SessionState& state,
                                                           const CornersSeen& seen, const SensorNoise& noise);
// Without a place.
[[nodiscard]] Observation Observe(const Layout& layout, const SessionState& state, const RelativeKnown& known);

// Pose of the tracker's body at the capture in the world of its place: what is told for it, moved on by as much as the
// clock is late.
[[nodiscard]] Se3 T_world_body(const SessionState& state, const PoseTold& told);
// Pose of the board in the sensor.
[[nodiscard]] Se3 T_sensor_board(const SessionState& state, const Where& where);

}  // namespace rigcal::calib::joint
