// Puts the corners of a checkerboard into their one order.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "server/base/result.h"
#include "server/detect/pictures/grey_image.h"

namespace rigcal::detect {

// Row-major, right-handed with z into the board as seen from the front (in the picture, columns x rows turn clockwise:
// x right, y down). One odd and one even count, or equal odd counts: the square between the first two corners of the
// first two rows is dark. That is one order for the former, two (half a turn apart) for the latter. Other counts: the
// square is dark or light as printed; two orders look alike, four if the counts are equal and even. Of orders that
// look alike it is the one whose first corner is the closest to the picture's top left (smallest x + y).
// Fails where the squares do not alternate or the rows cross: these corners are no board.
[[nodiscard]] Result<std::vector<Eigen::Vector2d>> Oriented(const GreyImage& image, int cols, int rows,
                                                            const std::vector<Eigen::Vector2d>& corners);

}  // namespace rigcal::detect
