// Which directions of T_body_lidar a motion before static planes tells. What the poses' own noise would tell by itself
// does not count: from noisy poses information comes even where true ones give none. A pose that many sightings correct
// is less noisy than the tracker's.
#pragma once

#include "server/calib/planes/static_planes.h"

namespace rigcal::calib {

// A direction counts if the change of the sightings that tells it is so many times what noise of the poses makes.
constexpr double kReachNoises = 3.0;

struct PlaneReach {
  // Orthonormal columns, right tangent at the lidar: what is open, and what is not.
  Directions open, free;
  double weakest_noises = 0.0;  // of the direction that is told least: its change over what noise makes
};
// `problem`: captures with the noise of their poses; its `free` is not used.
[[nodiscard]] PlaneReach ReachOf(const StaticProblem& problem, const StaticState& state);

// The open directions in words' terms, frame of the body: along which the position is not known whatever the rotation,
// and about which the rotation is not known.
struct OpenAxes {
  std::vector<Eigen::Vector3d> positions, turns;  // unit
};
[[nodiscard]] OpenAxes AxesOf(const PlaneReach& reach, const Se3& T_body_lidar);

}  // namespace rigcal::calib
