// Finds a grid of separate tags, whole or in part.
#pragma once

#include "server/detect/pictures/grey_image.h"
#include "server/model/sensors/features.h"
#include "server/model/sensors/target.h"

namespace rigcal::detect {

// Fills found, corners_px, corner_idx, or why_not. Reads tags with a border of one or two bits and with codes turned by
// any quarter: what makes the tags agree with each other holds. At least two tags. From behind as FindCharuco().
// Throws what OpenCV throws.
void FindTagGrid(const GreyImage& image, const Target& target, BoardView& view);

}  // namespace rigcal::detect
