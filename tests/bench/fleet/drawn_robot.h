// A robot that is drawn: where its sensors sit on each visit, and what a session says of that.
//
// By turns about an axis, shifts and 4 x 4 matrices alone: the server's SE(3) and its conventions take no part in it.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <array>
#include <random>

#include "server/model/sessions/session_estimate.h"

namespace rigcal::drawn_fleet {

constexpr std::size_t kSensors = 5, kReference = 1;
// Sorted; the second is the reference.
[[nodiscard]] const std::array<SensorId, kSensors>& Names();

// Of each sensor, in the robot's body.
using Places = std::array<Eigen::Isometry3d, kSensors>;
[[nodiscard]] Places Mounted();

// A shift (m) and then a turn (rad, about its own direction), both along the axes that T has.
[[nodiscard]] Eigen::Isometry3d Stepped(const Eigen::Isometry3d& T, const Vector6d& step);

// 1 sigma along every axis.
struct Sizes {
  double scatter_m = 5e-4, scatter_rad = 0.02 / 57.29577951308232;  // of a sensor's place from visit to visit
  double session_m = 2e-4, session_rad = 0.01 / 57.29577951308232;  // of a session's own errors
  int session_dof = 30;                                             // behind what a session says of these
  bool along_one_axis =
      false;  // all of it, with the same trace: of every other sensor along its x, of the rest along (1, 1, 1)
  bool reference_scatters = false;  // else the robot's body is what the reference is mounted to without play
};

// What chance makes of a visit.
struct VisitDraw {
  std::array<Vector6d, kSensors> scatter, errors;  // in each sensor's own axes; of the reference no errors
  double told_ratio = 1.0;                         // of the variance that the session states to the true one
};

class Draws {
 public:
  Draws(unsigned seed, unsigned robot);
  // Half of the variance of a session's errors is one shift and one turn of all its sensors against the reference.
  [[nodiscard]] VisitDraw Visit(const Places& places, const Sizes& sizes);
  // 0 to `count` - 1.
  [[nodiscard]] int Below(int count) { return std::uniform_int_distribution<>(0, count - 1)(engine_); }

 private:
  // Of a sensor's shifts or turns from visit to visit, 1 sigma per axis if all are alike.
  Eigen::Vector3d Scatter(std::size_t sensor, bool along_one_axis);
  Eigen::Vector3d Normal3() { return {normal_(engine_), normal_(engine_), normal_(engine_)}; }
  std::mt19937 engine_;
  std::normal_distribution<double> normal_;
};

// What the session states: poses in the frame of the reference with the joint covariance of its errors.
[[nodiscard]] SessionEstimate EstimateOf(const Places& places, const VisitDraw& draw, const Sizes& sizes,
                                         SessionId session);

}  // namespace rigcal::drawn_fleet
