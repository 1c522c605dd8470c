// What is counted of a drawn fleet, and its JSON.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "server/model/sessions/as_found.h"

namespace rigcal::drawn_fleet {

// Sessions in which nothing happened.
struct Quiet {
  int sessions = 0, accused = 0;
};
// Sessions before which one sensor was moved along one of its axes.
struct Events {
  int sessions = 0;
  int found = 0;     // a sensor is accused, whichever
  int axis = 0;      // the sensor that was moved is beyond the limit along that axis
  int named = 0;     // it is accused, and no other
  int for_sure = 0;  // likewise, and none stands beside it as the one that may have moved instead
  double smallest_m = 0.0, smallest_rad = 0.0;  // sums, of the axes along which and about which it was moved
  int shifts = 0;
};
// Slow drifts of one rate.
struct Drifts {
  int robots = 0, wrong = 0;          // wrong: the first that was accused is another sensor
  std::vector<int> weeks;             // that it took until it was told, of those that were
  std::vector<int> weeks_until_rate;  // until its rate was beyond four of its sigmas
};

struct FleetTally {
  std::map<int, Quiet> quiet;          // by visits in use
  std::map<int, Quiet> told_moved;     // revisions of robots to which nothing ever happened, by visits
  std::map<int, Quiet> told_apart;     // likewise, that warn of a sensor that sat elsewhere on another visit
  std::map<int, Quiet> remarks_apart;  // likewise, that pass with a remark on it
  std::map<std::string, std::map<int, Events>> events;  // by size in smallest changes ("1.0"), likewise
  std::map<std::string, Events> bumps;                  // likewise, of those that stay in a robot's history
  std::map<std::string, Drifts> drifts;                 // by mm in 30 days
  int swaps = 0, swaps_told = 0, swaps_accused = 0;     // told: as moved on purpose; accused: any sensor
  int missed_later = 0, missed = 0;  // bumps that their session did not tell; of these, that a later one did
};

[[nodiscard]] bool IsAccused(const AsFound& found);
// Adds a session before which `sensor` was moved by `step` along `axis`, m or rad.
void Count(const AsFound& found, const SensorId& sensor, int axis, double step, Events& events);
// One JSON object.
[[nodiscard]] std::string JsonOf(const FleetTally& tally);

}  // namespace rigcal::drawn_fleet
