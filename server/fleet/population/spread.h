// Robust places and spreads of numbers.
#pragma once

#include <vector>

#include "server/model/robots/population.h"

namespace rigcal::fleet {

// The value below which this part (0 to 1) of the values lies, between two of them by the straight line. `values` must
// not be empty; any order.
[[nodiscard]] double QuantileOf(std::vector<double> values, double part);
// 1.4826 times the median distance from `median`: 1 sigma of normal values, whatever fewer than half of them are.
[[nodiscard]] double RobustSpread(const std::vector<double>& values, double median);
[[nodiscard]] AxisSpread SpreadOf(const std::vector<double>& values);

// T such that the coordinate medians of Log(T^-1 T_i) are zero, but for rounding. `poses` must not be empty. The order
// of the poses matters by rounding only.
[[nodiscard]] Se3 MedianPose(const std::vector<Se3>& poses);

}  // namespace rigcal::fleet
