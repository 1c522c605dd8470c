// A fleet over a year: every robot is visited once a week; some are bumped, some drift, of some a sensor is swapped.
#pragma once

#include "tests/bench/fleet/drawn_robot.h"
#include "tests/bench/fleet/fleet_tally.h"

namespace rigcal::drawn_fleet {

struct FleetPlan {
  int robots = 1000, weeks = 52;
  unsigned seed = 1;
  // Sessions that are drawn beside each quiet one, against the same calibration in use: without and with an event.
  int beside = 1;
  bool alone = false;  // nobody knows what the other robots scatter by
  Sizes sizes;
};

// Robots join evenly over the first quarter. Of ten robots one is bumped by the smallest change that the session after
// it tells, one by 1.2 times that, of one a sensor is swapped and said to be remounted, one drifts, and nothing happens
// to six.
[[nodiscard]] FleetTally RunFleet(const FleetPlan& plan);

}  // namespace rigcal::drawn_fleet
