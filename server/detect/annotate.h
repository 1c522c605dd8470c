// The picture of a detection, for reports.
#pragma once

#include <string>

#include "server/detect/grey_image.h"
#include "server/model/features.h"

namespace rigcal::detect {

// JPEG: the picture with corners joined row by row, the origin ringed, x and y named; at most 1280 px wide. Without
// corners: the bare picture. The same input gives the same bytes. Throws what OpenCV throws.
[[nodiscard]] std::string Annotated(const GreyImage& image, const BoardView& view, int inner_cols);

}  // namespace rigcal::detect
