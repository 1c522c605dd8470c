// How sharp a board is in a picture: how wide the edges between its dark and its light squares are.
#pragma once

#include <optional>

#include "server/detect/pictures/grey_image.h"
#include "server/model/sensors/features.h"
#include "server/model/sensors/target.h"

namespace rigcal::check {

// Pixels from a tenth to nine tenths of the step from dark to light, across the edges between neighbouring points of a
// board that was found: the median of those along its columns or of those along its rows, whichever is wider, for
// motion blurs one kind only. A Gaussian blur of sigma s gives 2.56 s. Nothing where the squares are too small to tell.
[[nodiscard]] std::optional<double> EdgeWidth_px(const detect::GreyImage& image, const BoardView& view,
                                                 const Target& board);

// Edges from this width on are blurred, in pictures of this width by a camera whose edges usually are `usual_px` wide:
// 6 px, or 1/400 of the picture if that is more. Camera or board moved by about so much while the picture was taken,
// and cameras that expose a little apart then see the board farther apart than the 1/600 of the picture that a pair is
// refused for. A picture of twice the usual stands out, too, from 4 px on.
[[nodiscard]] double BlurredFrom_px(int image_width_px, double usual_px);

}  // namespace rigcal::check
