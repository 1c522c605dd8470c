// A lidar on a tracked body before plates that stand still, with known truth: points where rays meet the plates, by
// nothing that is under test.
#pragma once

#include <vector>

#include "server/calib/tracker_lidar/tracker_lidar.h"
#include "tests/unit/calib/virtual_motion.h"

namespace rigcal::calib {

struct VirtualPlates {
  std::vector<Se3> T_world_plate;  // origin in the middle, z away from the room's middle
  Eigen::Vector2d size_m{1.1, 0.8};
  double range_sigma_m = 0.0, range_bias_m = 0.0;
  PoseNoise tracker;
  bool decoys = false;       // every cloud also has two patches that are elsewhere in every capture, listed first
  bool boards_move = false;  // they stand elsewhere in every capture
  bool nominal = true;       // the drawing is off by 2 cm and 1 degree
};
// Plates 4.5 m from the world's origin, facing it, tilted by some degrees: to the front, left, right and above.
[[nodiscard]] VirtualPlates FourPlates();
// Points of a plate on a grid of 8 x 30; of plates seen from behind or at more than 75 degrees none.
[[nodiscard]] TrackerLidarProblem Scanned(const VirtualBody& body, const VirtualPlates& plates, unsigned seed);

// Covariance of T_body_lidar that an estimator cannot beat (Cramer-Rao): from every single point, the body's poses and
// plates unknown, by numerical derivatives. Infinite where something is open.
[[nodiscard]] Matrix6d BoundOf(const VirtualBody& body, const VirtualPlates& plates);

}  // namespace rigcal::calib
