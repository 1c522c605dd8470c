// What range errors of single beams do to the pose of two lidars.
#pragma once

#include "server/calib/lidar_lidar/lidar_lidar_work.h"

namespace rigcal::calib {

// How T_map_moving (right tangent) changes per metre that the ranges of each group of beams are longer, one column per
// group (beam_groups.h): of the lidar that makes the map, of the one that moves. Linear at the pose: a group more is
// one more right side, not one more registration. Zero along `unknown`.
struct BeamShifts {
  Directions of_map, of_moving;
};
[[nodiscard]] BeamShifts ShiftsByBeams(const LidarLidarProblem& problem, const LidarLidarWork& work,
                                       const Se3& T_map_moving, const Directions& unknown);

}  // namespace rigcal::calib
