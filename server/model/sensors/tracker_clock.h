// What a session says of the clock of a tracker whose body moved while captures were taken.
#pragma once

#include <cmath>

#include "server/base/ids.h"

namespace rigcal {

constexpr double kClockToldMin_s = 1e-3, kClockToldMinSigmas = 3.0;

// What the tracker tells for an instant is where its body was late_s before (negative: after). Taken out of the poses
// as far as the session tells it.
struct TrackerClock {
  SensorId tracker;
  double late_s = 0.0, sigma_s = 0.0;
  double given_sigma_s = 0.0;  // what was taken to be known of it before
  int captures = 0;            // in which its body moved; 0: it stood still, and late_s is what was known before

  // Whether the session says more of it than was known before.
  [[nodiscard]] bool IsKnown() const { return captures > 0 && sigma_s < 0.5 * given_sigma_s; }
  // Whether it is surely off, by so much that people are told.
  [[nodiscard]] bool IsOff() const {
    return std::abs(late_s) > kClockToldMin_s && std::abs(late_s) > kClockToldMinSigmas * sigma_s;
  }
};

}  // namespace rigcal
