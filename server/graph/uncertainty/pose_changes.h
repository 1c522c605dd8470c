// What a calibration would change against another: sensor by sensor, the largest effect first.
#pragma once

#include <vector>

#include "server/model/graph/joint_poses.h"
#include "server/model/graph/pose_change.h"

namespace rigcal::graph {

// Both are laid together at the reference of `after`: e = Log(T_before^-1 T_after), right tangent at the sensor; its
// lengths, and its worst axis in sigmas of `before`. What only one of them knows comes first; then by sigmas, those
// without any after the others, then by name. Sensors whose pose is the same within 1e-12 m and rad are left out, as is
// the reference. Without the reference of `after` in `before`: all are gained and lost.
[[nodiscard]] std::vector<PoseChange> PoseChangesBetween(const JointPoses& before, const JointPoses& after);

}  // namespace rigcal::graph
