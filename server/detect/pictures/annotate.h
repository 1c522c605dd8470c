// The picture of a detection, for reports.
#pragma once

#include <string>

#include "server/detect/pictures/grey_image.h"
#include "server/model/sensors/features.h"
#include "server/model/sensors/target.h"

namespace rigcal::detect {

// JPEG, at most 1280 px wide. A checkerboard: corners joined row by row, the origin ringed, x and y named. Other
// targets: corners ringed and joined with the next ones along rows (of a tag: around it) where found, some with their
// indices, x and y at the origin or at the first corner found. Without corners: the bare picture. The same input gives
// the same bytes. Throws what OpenCV throws.
[[nodiscard]] std::string Annotated(const GreyImage& image, const BoardView& view, const Target& target);

}  // namespace rigcal::detect
