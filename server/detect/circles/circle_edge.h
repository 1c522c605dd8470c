// The outline of a circle's picture, to a small part of a pixel.
#pragma once

#include <optional>

#include "server/detect/circles/blobs.h"

namespace rigcal::detect {

// `ellipse` is right to about a pixel; `clear_ratio`: how far the background reaches beyond the edge, in radii. The
// centre is the centroid of what lies within the outline, where grey is midway between inside and outside. Blur that is
// the same to all sides does not move it. Nothing where the outline is covered, cut by the picture's border or not that
// of an ellipse. Throws nothing.
[[nodiscard]] std::optional<Ellipse> Sharpened(const GreyImage& image, const Ellipse& ellipse, double clear_ratio);

}  // namespace rigcal::detect
