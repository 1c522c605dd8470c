// Finds a target of any kind in a picture.
#pragma once

#include <span>
#include <string>

#include "server/detect/pictures/grey_image.h"
#include "server/model/sensors/features.h"
#include "server/model/sessions/session.h"

namespace rigcal::detect {

// Names algorithm, version, kind, geometry, layout, dictionary and target: the key of the cache. What another version
// stored is not found any more, and made again.
[[nodiscard]] std::string DetectorKey(const Target& target);
// PNG or JPEG bytes, 8 or 16 bit, grey or colour; the header's dimensions are checked against limits before decoding.
// What is wrong with the picture or the target is view.why_not; a size of 0 x 0 means that nothing was found out about
// the picture, which is nothing to keep. Throws std::bad_alloc where there is no memory. Corners have sub-pixel places
// and the indices of TargetPoints(). A checkerboard is seen whole, in the order of Oriented(); boards with markers may
// be seen in part. Pure: the same bytes give the same corners.
[[nodiscard]] AnnotatedView Detect(std::span<const std::byte> encoded, const Target& target);
// The view alone, of a picture that is decoded: that of Detect() of the same pixels.
[[nodiscard]] BoardView FindIn(const GreyImage& image, const Target& target);

}  // namespace rigcal::detect
