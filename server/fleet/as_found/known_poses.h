// Poses of a rig as a revision or a session tells them, seen from any of its sensors.
#pragma once

#include <Eigen/Core>
#include <functional>
#include <optional>
#include <vector>

#include "server/model/graph/graph.h"
#include "server/model/graph/joint_poses.h"
#include "server/model/sessions/session_estimate.h"

namespace rigcal::fleet {

struct KnownPose {
  SensorId sensor;
  Se3 T_ref_sensor;
  double dof = 0.0;  // behind its covariance; 0: known
  int visits = 0;    // whose refinement tells it
  // What its place scatters by from visit to visit, per axis. Of a revision it is in the covariance.
  Vector6d visit_variance = Vector6d::Zero();
  std::optional<ScatterDof> scatter_dof = {};    // behind that; nothing: one for each of its visits beyond the first
  int scatter_robots = 0;                        // other robots that stand behind all of it besides
  Vector6d assumed_variance = Vector6d::Zero();  // part of the covariance that nobody has told, of this and one visit

  // Behind what shifts and what turns scatter by, either of which may be told alone; 0: nothing tells it.
  [[nodiscard]] ScatterDof DofOfScatter() const;
};

struct KnownPoses {
  SensorId reference;
  std::vector<KnownPose> poses;  // the reference, too
  Eigen::MatrixXd covariance;    // of the poses in their order, the reference left out: six rows each, right tangents

  // Null: it is not among them.
  [[nodiscard]] const KnownPose* Find(const SensorId& sensor) const;
};

// Of a session's own estimate (`why_not` empty); and those that a solution knows, with the joint covariance of the
// fused sensors. Where none were fused it is that of `joint`, if it has all sensors; others stand apart, by their own.
[[nodiscard]] KnownPoses PosesOf(const SessionEstimate& estimate);
[[nodiscard]] KnownPoses PosesOf(const GraphSolution& solution, const SensorId& reference,
                                 const std::vector<JointCovariance>& joint = {});

// So many days later than their covariance is told for: sensors walk on (FusedPose::walk_...). Of zero and less
// nothing.
void WalkOn(const GraphSolution& solution, double days, KnownPoses& poses);

// Those that `is_one` takes; the frame stays that of the reference, though it may be left out.
[[nodiscard]] KnownPoses Some(const KnownPoses& poses, const std::function<bool(const SensorId&)>& is_one);

// Some of them in the frame of one: T_f_s = T_ref_f^-1 T_ref_s, xi_fs = xi_s - Ad(T_f_s^-1) xi_f.
struct PosesSeen {
  std::vector<Se3> T_frame_sensor;
  std::vector<double> dof;              // the smaller of both sensors'; 0: known
  std::vector<ScatterDof> scatter_dof;  // likewise, behind `scatter`; 0: known, or nothing tells it
  Eigen::MatrixXd covariance;           // six rows per sensor
  Eigen::VectorXd scatter;              // variance per row: what both sensors scatter by from visit to visit
  Eigen::VectorXd assumed;              // likewise, of the covariance: what nobody has told
};
// What a pose says nothing about (variance not finite, or zero or less) has kNothingKnown for its variance.
constexpr double kNothingKnown = 1e12;
// `frame` and `sensors` must be among the poses.
[[nodiscard]] PosesSeen SeenFrom(const SensorId& frame, const std::vector<SensorId>& sensors, const KnownPoses& poses);
// Of one sensor's six rows, what PosesSeen::scatter has; both must be among the poses, whose covariance does not
// matter.
[[nodiscard]] Vector6d ScatterSeenFrom(const SensorId& frame, const SensorId& sensor, const KnownPoses& poses);
// T_frame_sensor; nothing where one of both is not among them.
[[nodiscard]] std::optional<Se3> PlaceIn(const SensorId& frame, const SensorId& sensor, const KnownPoses& poses);

}  // namespace rigcal::fleet
