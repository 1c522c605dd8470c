// Values that tests of several parts of the model use.
#pragma once

#include <limits>

#include "server/base/stamp.h"

namespace rigcal {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

inline Stamp At(const char* iso) { return ParseIso(iso).value(); }

}  // namespace rigcal
