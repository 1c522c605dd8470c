// Puts the corners of a checkerboard into their one order.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "server/base/result.h"
#include "server/detect/grey_image.h"

namespace rigcal::detect {

// Row-major, right-handed with z into the board as seen from the front (in the picture, columns x rows turn clockwise:
// x right, y down), and the square between the first two corners of the first two rows is dark. That is one order,
// because one count is odd and one even; the caller sees to that.
// Fails where the squares do not alternate or the rows cross: these corners are no board.
[[nodiscard]] Result<std::vector<Eigen::Vector2d>> Oriented(const GreyImage& image, int inner_cols, int inner_rows,
                                                            const std::vector<Eigen::Vector2d>& corners);

}  // namespace rigcal::detect
