// The quick search of a checkerboard: saddle points on an image pyramid, joined to grids.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "server/detect/pictures/grey_image.h"

namespace rigcal::detect {

struct GridPart {
  Eigen::Vector2d min_px, max_px;  // around its corners
  double square_px = 0;            // the mean distance from corner to corner
  std::size_t corners = 0;
};

struct BoardSearch {
  // Row-major, to about half a pixel of the level where the board was found; in an order that still needs Oriented().
  // Empty: no grid of exactly these counts.
  std::vector<Eigen::Vector2d> corners_px;
  // Without corners: where the board may be all the same, because a part of such a grid is there; the largest part
  // first. `others`: whole grids of other counts, or larger ones: there is none.
  std::vector<GridPart> parts, others;
};

// Boards from about 7 pixels a square. A larger pattern is no board, nor is a board of which corners cannot be seen.
// The same for any number of threads.
[[nodiscard]] BoardSearch SearchBoard(const GreyImage& image, int cols, int rows);

// Is it in the place of the other one, which has as many corners at least? Texture of much smaller squares says
// nothing.
[[nodiscard]] bool IsPartOf(const GridPart& part, const GridPart& other);

}  // namespace rigcal::detect
