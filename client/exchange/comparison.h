// A calibration against other poses of the same rig, for people and as JSON (docs/api.md, compare).
#pragma once

#include <cstdint>
#include <optional>
#include <ostream>
#include <string>
#include <vector>

#include "client/exit_code.h"
#include "client/text/pose_comparison.h"

namespace rigcal::client {

struct NotCompared {
  std::string sensor, why;  // "is not in robot.urdf"
};

struct Comparison {
  std::string robot, reference, other;  // other: a revision or a file, as people call it
  std::int64_t revision = 0;
  std::vector<PoseDifference> differences;       // not empty
  std::vector<NotCompared> not_compared = {};    // sensors that one of both has no pose of
  std::string cure = {};                         // a sentence for them, where there is one
  std::vector<std::string> waived = {};          // sensors that the other side need not have, and has not
  std::optional<std::size_t> other_frames = {};  // of a file: frames that are no sensors of the calibration
};

// A row per sensor: moved, turned, sigma, the worst axis in sigmas; rms below, and what was not compared.
void PrintComparison(const Comparison& comparison, std::ostream& out);
[[nodiscard]] std::string ComparisonJson(const Comparison& comparison);
// 1 where an axis is off by more than `sigmas_max` sigmas, where that is not 0; 6 where a sensor was not compared, or
// of a limit where a sigma is not known; else 0.
[[nodiscard]] ExitCode JudgeComparison(const Comparison& comparison, double sigmas_max);

}  // namespace rigcal::client
