// How many captures people are asked for, and from how many on the pairs of a session check each other. Of a robot's
// first visit under the default policy that is one answer before a push and after it; later the edges of other visits
// count as well, and the robot's own policy, of which nothing before a push knows.
#pragma once

#include <cstddef>

#include "server/model/approval/policy.h"

namespace rigcal {

// Of each pair of sensors, where there were too few.
inline constexpr int kCapturesUsual = 20;

// A limit above this would let ten sigmas through: such a test of a residual says nothing, so there is none.
inline constexpr double kResidualLimitMax = 100.0;
// Independent captures of an edge from which its residual can be tested in all six directions among so many edges,
// which share the odds of a false accusation.
[[nodiscard]] int CapturesToTest(std::size_t edge_count, const Policy& policy = {});
// What is asked for, of so many edges.
[[nodiscard]] int CapturesToAskFor(std::size_t edge_count, const Policy& policy = {});

// A sensor with so many files for the captures of its pair lacks enough of them to be told so, though the pair was
// calibrated: three and a quarter of all.
[[nodiscard]] constexpr bool LacksFiles(double files, double captures) {
  constexpr double kLostMin = 3, kLostMin_ratio = 0.25;
  return captures - files >= kLostMin && captures - files >= kLostMin_ratio * captures;
}
// Most files of a sensor are of captures that the other of its pair has none of: neither lost any.
[[nodiscard]] constexpr bool RecordedApart(double files, double files_of_other, double captures) {
  return 2 * (captures - files_of_other) > files;
}
// A third sensor that shares no capture with a sensor recorded in turn with it, in another pass or group: what it has
// files of, the sensor does not lack. Of a few files, or few beside the sensor's, that says nothing.
[[nodiscard]] constexpr bool RecordedInTurn(double files, double files_of_third, double shared_captures) {
  constexpr double kFilesOfPassMin = 3, kFilesOfPassMin_ratio = 0.25;
  return shared_captures == 0 && files > 0 && files_of_third >= kFilesOfPassMin &&
         files_of_third >= kFilesOfPassMin_ratio * files;
}

}  // namespace rigcal
