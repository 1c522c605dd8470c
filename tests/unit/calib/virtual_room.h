// Two lidars in a room of flat panels: scans by ray casting, analytic truth.
#pragma once

#include <string>
#include <vector>

#include "server/calib/lidar_lidar/lidar_lidar.h"
#include "tests/unit/simulated_scan.h"

namespace rigcal::calib {

enum class RoomKind { kFurnished, kCorridor };

struct VirtualRoom {
  RoomKind kind = RoomKind::kFurnished;
  Se3 T_a_b;  // truth: b is turned to scan another way
  Beams beams_a, beams_b;
  double start_m = 0.1, start_rad = 0.05;  // of each component of the nominal pose's error
  VirtualRoom();
};

// Captures from different places of the room; every random number from `seed`.
[[nodiscard]] LidarLidarProblem RecordedIn(const VirtualRoom& room, int captures, unsigned seed);
// Every beam of both lidars is off by a constant of its own, drawn from `seed`; a beam is what has one elevation.
void SpoilBeams(double sigma_m, unsigned seed, LidarLidarProblem& problem);
// The same pair the other way round.
[[nodiscard]] LidarLidarProblem Exchanged(const LidarLidarProblem& problem);

}  // namespace rigcal::calib
