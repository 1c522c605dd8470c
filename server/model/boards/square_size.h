// The measured size of a board's squares in the place of what a session states.
#pragma once

#include <map>
#include <vector>

#include "server/base/ids.h"
#include "server/model/boards/measure.h"
#include "server/model/sensors/target.h"

namespace rigcal {

struct SquareSize {
  double square_m = 0.0, square_sigma_m = 0.0;  // as those of Target
  friend bool operator==(const SquareSize&, const SquareSize&) = default;
};
using SquareSizes = std::map<TargetId, SquareSize>;

// One size for both directions: the mean of x and y. Half their difference is a part of its sigma, besides the
// readings'.
[[nodiscard]] SquareSize SquareSizeOf(const BoardMeasure& measure);
// Those targets that have one get it; what was printed with the squares (markers) is scaled alike. Others stay as they
// are.
void TakeSizes(const SquareSizes& sizes, std::vector<Target>& targets);

}  // namespace rigcal
