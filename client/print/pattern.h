// A board as what is black on it.
#pragma once

#include <vector>

#include "server/base/result.h"
#include "server/model/sensors/target.h"

namespace rigcal::print {

// x to the right, y down, metres.
struct Rectangle {
  double x_m = 0, y_m = 0, width_m = 0, height_m = 0;
};

struct Disc {
  double x_m = 0, y_m = 0, diameter_m = 0;  // of its centre
};

struct Pattern {
  double width_m = 0, height_m = 0;  // of all that is black
  std::vector<Rectangle> black;      // from the top left of the pattern; none overlaps another
  std::vector<Disc> discs = {};      // black, too
};

// `target` must be valid (Validate). The top left square of a checkerboard or charuco is black, or, of a legacy charuco
// with an even number of rows, white. kInvalidInput where its dictionary has too few markers.
[[nodiscard]] Result<Pattern> DrawPattern(const Target& target);

}  // namespace rigcal::print
