// Which messages of several sensors were taken together, by their stamps.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace rigcal::importing {

// What one sensor took: a stamp for each of its messages, in the order of the bag.
struct SensorStamps {
  std::vector<std::int64_t> stamps_ns;
  bool forms_captures = true;  // cameras and lidars; a tracker has a pose for a capture, and makes none
};

struct PlannedCapture {
  std::string name;           // "1586406456-763032325": seconds and nanoseconds of its stamp
  std::int64_t stamp_ns = 0;  // of the sensor that has the fewest messages
  std::vector<std::optional<std::size_t>>
      message;  // of each sensor: which of its messages; nothing: none is near enough
};

// What became of a sensor's messages; together they are all of them.
struct SensorUse {
  std::size_t used = 0;             // in a capture
  std::size_t without_partner = 0;  // no other sensor has a message within the tolerance
  std::size_t repeated_stamp = 0;   // the stamp of a message before it
  std::size_t thinned_out = 0;      // their capture was too soon after another one
  std::size_t left_out = 0;         // of a stream: their moment is no capture, or they are no picture for one
};

struct CapturePlan {
  std::vector<PlannedCapture> captures;  // by stamp
  std::vector<SensorUse> uses;           // of each sensor
};

// Nearest matches, each message in one capture at most: from the sensor with the fewest messages on (of equals the
// first), each message that is still free takes of every other sensor the free one nearest to it, if that is within
// `tolerance_ns` and has no nearer one on this side. A capture has two sensors that form captures, or one where there
// is one only. Captures closer than `every_ns` to the one before are left out. The same stamps give the same plan.
[[nodiscard]] CapturePlan PlanCaptures(const std::vector<SensorStamps>& sensors, std::int64_t tolerance_ns,
                                       std::int64_t every_ns);

}  // namespace rigcal::importing
