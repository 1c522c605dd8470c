// What the other edges of a graph know of the pose that one of them measures.
#pragma once

#include <map>

#include "server/base/ids.h"
#include "server/math/se3.h"

namespace rigcal {

// By edge, as far as it was worked out: the information that all others together have about what it measures, right
// tangent at b, 1/m^2 and 1/rad^2; zero along what none of them checks, and along what it does not measure itself.
using OtherPaths = std::map<EdgeId, Matrix6d>;

}  // namespace rigcal
