// Circles in rows and columns.
#pragma once

#include <map>
#include <utility>
#include <vector>

#include "server/detect/circles/blobs.h"

namespace rigcal::detect {

// Column and row, counted from anywhere; x along one row to the next circle, y a quarter turn clockwise from it in the
// picture.
using CirclePlace = std::pair<int, int>;
using CircleLattice = std::map<CirclePlace, Ellipse>;

// Those of one shade that hang together as nearest neighbours of a square lattice do, the largest first; `pitch_ratio`:
// distance of nearest centres over a circle's radius. An ellipse says how the board is foreshortened about it, so a
// neighbour's direction and distance are compared as seen from the front. A lattice whose circles contradict each other
// is left out.
[[nodiscard]] std::vector<CircleLattice> LatticesOf(const std::vector<Ellipse>& ellipses, double pitch_ratio);

}  // namespace rigcal::detect
