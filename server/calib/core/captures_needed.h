// How many captures each method wants of a pair, for those who ask before there is anything to estimate.
#pragma once

#include <cstddef>

#include "server/model/method.h"

namespace rigcal::calib {

// Captures in which both sensors see what the method goes by. Zeros: the method does not go by captures.
struct CapturesNeeded {
  std::size_t least = 0;   // fewer: there is no answer
  std::size_t enough = 0;  // fewer: a note on the edge says that its uncertainty is rough
};
// The limits that the estimator of this method holds itself to.
[[nodiscard]] CapturesNeeded NeededBy(Method method);

}  // namespace rigcal::calib
