// What two tell differently of a rig, seen from one of its sensors, and which sensor explains it.
#pragma once

#include "server/fleet/as_found/known_poses.h"

namespace rigcal::fleet {

struct ChangeSeen {
  SensorId frame;                   // the sensor from which it is seen
  std::vector<SensorId> sensors;    // the others
  std::vector<Se3> T_frame_before;  // of each
  // Six rows per sensor: T_after = T_before Exp(change), right tangents; covariance of both sides together, which err
  // apart.
  Eigen::VectorXd change;
  Eigen::MatrixXd covariance;
  Eigen::VectorXd assumed;  // per row, of its variance: what nobody has told (KnownPose::assumed_variance)
  // Per row (Welch 1947; Satterthwaite 1946), and not more than stand behind what visits scatter by
  // (KnownPose::scatter_dof); 0: known.
  std::vector<double> dof;

  // Of a row of `change`, m or rad.
  [[nodiscard]] double Sigma(Eigen::Index row) const;
  // A sigma beyond a metre or a radian says nothing of a rig.
  [[nodiscard]] bool IsMeasured(Eigen::Index row) const;
};
// Of the sum of two variances (Welch 1947; Satterthwaite 1946); 0: known.
[[nodiscard]] double WelchDof(double a, double dof_a, double b, double dof_b);
// `frame` and `sensors` must be among the poses of both.
[[nodiscard]] ChangeSeen ChangeBetween(const SensorId& frame, const std::vector<SensorId>& sensors,
                                       const KnownPoses& before, const KnownPoses& after);

struct Mover {
  SensorId sensor;
  SensorId or_else = {};  // explains it as well: not a hundred times less likely
};
// The one sensor, the frame too, whose step of six numbers explains the whole change best: its gain d^T S^-1 E m is the
// largest. Of two that explain it alike the one that is not the frame comes first. `seen` has a sensor at least.
[[nodiscard]] Mover LikeliestMover(const ChangeSeen& seen);

}  // namespace rigcal::fleet
