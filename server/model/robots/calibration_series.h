// How the calibrations of a robot followed each other: what lists draw of its past.
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "server/base/stamp.h"

namespace rigcal {

// What holds from one calibration on, until the next one.
struct CalibrationPoint {
  Stamp calibrated_at;                      // Validity's, of the newest revision that has it
  std::optional<double> worst_sigmas = {};  // its worst edge's residual over its own sigma; absent: nothing checks one
  friend bool operator==(const CalibrationPoint&, const CalibrationPoint&) = default;
};
inline constexpr std::size_t kCalibrationsListedMax = 26;  // half a year of weekly visits

// Of the points of a robot's revisions, the newest revision first: those that led to what the newest is made of, the
// oldest first, at most kCalibrationsListedMax. What a revision counted that was taken back since, and what was
// calibrated again, are left out.
[[nodiscard]] std::vector<CalibrationPoint> CalibrationsOf(const std::vector<CalibrationPoint>& newest_first);

}  // namespace rigcal
