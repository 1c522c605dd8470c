// A calibration against other poses of the same rig, for people and as JSON (docs/api.md, compare).
#pragma once

#include <cstdint>
#include <ostream>
#include <string>
#include <vector>

#include "client/exit_code.h"
#include "client/text/pose_comparison.h"

namespace rigcal::client {

struct Comparison {
  std::string robot, reference, other;  // other: a revision or a file, as people call it
  std::int64_t revision = 0;
  std::vector<PoseDifference> differences;  // not empty
  std::vector<std::string> missing = {};    // sensors of the calibration that the other side lacks, where that is told
};

// A row per sensor: moved, turned, sigma, the worst axis in sigmas; rms below.
void PrintComparison(const Comparison& comparison, std::ostream& out);
[[nodiscard]] std::string ComparisonJson(const Comparison& comparison);
// 1 where an axis is off by more than so many sigmas, 6 where a sigma is not known, else 0.
[[nodiscard]] ExitCode JudgeSigmas(const Comparison& comparison, double sigmas_max);

}  // namespace rigcal::client
