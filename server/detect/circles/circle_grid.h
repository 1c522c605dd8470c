// Finds a grid of circles.
#pragma once

#include "server/detect/pictures/grey_image.h"
#include "server/model/sensors/features.h"
#include "server/model/sensors/target.h"

namespace rigcal::detect {

// Fills found, corners_px, corner_idx, or why_not. Whole or not at all: a grid that is cut or partly covered may be
// another part of the board, and one that goes on may be another board. Dark circles on light ground or light ones on
// dark. Points are pictures of the circles' centres (see CentresFrom). A grid that looks alike when turned comes in the
// order of which the first circle is the closest to the picture's top left (smallest x + y). Throws what OpenCV throws.
void FindCircleGrid(const GreyImage& image, const Target& target, BoardView& view);

}  // namespace rigcal::detect
