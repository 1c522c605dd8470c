// Finds a ChArUco board: a checkerboard with markers in its white squares, whole or in part.
#pragma once

#include "server/detect/pictures/grey_image.h"
#include "server/model/sensors/features.h"
#include "server/model/sensors/target.h"

namespace rigcal::detect {

// Fills found, corners_px, corner_idx, or why_not. Corners next to a marker that was read and agrees with its
// neighbours; each where four squares of alternating colours meet. Dark on light or light on dark. At least six, not on
// a line. Throws what OpenCV throws.
void FindCharuco(const GreyImage& image, const Target& target, BoardView& view);

}  // namespace rigcal::detect
