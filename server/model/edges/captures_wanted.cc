#include "server/model/edges/captures_wanted.h"

#include <algorithm>

#include "server/math/statistics.h"

namespace rigcal {

int CapturesToTest(std::size_t edge_count, const Policy& policy) {
  constexpr int kAllDirections = 6, kCapturesMax = 200;
  const double probability =
      1.0 - (1.0 - policy.residual_probability) / static_cast<double>(std::max<std::size_t>(edge_count, 1));
  int captures = kAllDirections + 2;
  while (captures < kCapturesMax && HotellingLimit(captures, kAllDirections, probability) > kResidualLimitMax)
    ++captures;
  return captures;
}

int CapturesToAskFor(std::size_t edge_count, const Policy& policy) {
  return std::max(kCapturesUsual, CapturesToTest(edge_count, policy));
}

}  // namespace rigcal
