#include "server/model/boards/square_size.h"

#include <cmath>

namespace rigcal {

SquareSize SquareSizeOf(const BoardMeasure& measure) {
  const BoardSize size = SizeOf(measure);
  const double by_readings_m = 0.5 * std::hypot(size.sigma_x_m, size.sigma_y_m);
  return {0.5 * (size.x_m + size.y_m), std::hypot(by_readings_m, 0.5 * (size.x_m - size.y_m))};
}

void TakeSizes(const SquareSizes& sizes, std::vector<Target>& targets) {
  for (Target& target : targets) {
    const auto found = sizes.find(target.id);
    if (found == sizes.end()) continue;
    target.marker_m *= found->second.square_m / target.square_m;
    target.square_m = found->second.square_m;
    target.square_sigma_m = found->second.square_sigma_m;
  }
}

}  // namespace rigcal
