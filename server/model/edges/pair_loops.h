// Which pairs of a session check each other.
#pragma once

#include <cstddef>
#include <vector>

namespace rigcal {

// Two sensors of a session by their numbers, and whether the pose of one in the other is told whole.
struct PairOfSession {
  std::size_t a = 0, b = 0;
  bool is_whole = false;
};
// Of each pair: it and others, all of them whole, close a loop. These check each other, once each has CapturesToTest()
// (captures_wanted.h).
[[nodiscard]] std::vector<bool> AreInLoops(const std::vector<PairOfSession>& pairs);

}  // namespace rigcal
