// Finds a checkerboard in an encoded picture.
#pragma once

#include <span>
#include <string>

#include "server/model/features.h"
#include "server/model/session.h"

namespace rigcal::detect {

// Names algorithm, version and geometry: the key of the cache.
[[nodiscard]] std::string DetectorKey(const Checkerboard& board);
// PNG or JPEG bytes, 8 or 16 bit, grey or colour; the header's dimensions are checked against limits before decoding.
// Never fails: what is wrong with the picture or the board is view.why_not. Corner order is canonical: a board with one
// odd and one even corner count has only one orientation; it is told by the colour of the squares.
// Sub-pixel corners; pure: the same bytes give the same corners.
[[nodiscard]] AnnotatedView Detect(std::span<const std::byte> encoded, const Checkerboard& board);

}  // namespace rigcal::detect
