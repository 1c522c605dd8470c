// Sensors of which some directions were not measured (SensorPose::measured_part), tested along the others.
//
// Both sides' open directions are right tangents at the sensor. What is at right angles to all of them was measured by
// both; along them poses hold what nobody measured, so of the change d only P d is looked at, P = I - Q Q^T, Q an
// orthonormal basis of both, in m and rad. Directions of both that are within 5 degrees of each other are one: what
// both hold along it differs by q^T d, and shows as q^T d r in P d, with r the part of the one at right angles to the
// other, which is added to what is not known.
#pragma once

#include "server/fleet/as_found/change_seen.h"
#include "server/model/approval/policy.h"

namespace rigcal::fleet {

struct PartlyKnown {
  SensorId sensor;
  Se3 T_ref_sensor;
  Matrix6d covariance = Matrix6d::Zero();  // right tangent at the sensor; nothing along what is open
  std::vector<Vector6d> open = {};         // right tangents at the sensor; none: it is known whole
  double dof = 0.0;                        // behind the covariance; 0: known
};
// Of one sensor, both sides told from one reference, by which sensors are seen that were not measured whole.
struct PartOfBoth {
  PartlyKnown in_use, session;
};

// What a solution was told of the sensor by pairs in part, or whole; nothing where neither. `edges`: of the solution,
// for the degrees of freedom.
[[nodiscard]] std::optional<PartlyKnown> PartOf(const SensorId& sensor, const GraphSolution& solution,
                                                const std::vector<Edge>& edges);

// The change as ChangeSeen has it, of this sensor alone, told from `frame`, of whose pose in the reference both sides
// tell what is given; rows within 10 degrees of what is open are not measured. `scatter`: what the sensor is taken to
// scatter by from visit to visit, of which nobody tells (1 sigma per axis). Nothing where both hold what is open so far
// apart (0.1 m or rad) that the rest cannot be told from it.
struct FrameOfBoth {
  SensorId frame;
  Se3 T_ref_in_use, T_ref_session;
  Matrix6d covariance_in_use = Matrix6d::Zero(), covariance_session = Matrix6d::Zero();  // right tangents at the frame
};
[[nodiscard]] std::optional<ChangeSeen> ChangeOfPart(const PartOfBoth& part, const FrameOfBoth& frame,
                                                     const PoseLimit& scatter);

}  // namespace rigcal::fleet
