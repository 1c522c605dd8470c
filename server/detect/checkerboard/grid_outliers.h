// Saddle points that are in a grid by mistake.
#pragma once

#include "server/detect/checkerboard/saddle_grid.h"

namespace rigcal::detect {

// Takes out the node that is the furthest from where the others say, again and again, until all are near enough.
void DropGridOutliers(SaddleGrid& grid);

}  // namespace rigcal::detect
