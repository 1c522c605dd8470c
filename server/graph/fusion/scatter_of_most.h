// How the places that edges of one pair have scatter, as most of them have it.
#pragma once

#include <vector>

#include "server/math/se3.h"
#include "server/math/tangent.h"

namespace rigcal::graph {

// What one edge of full rank says of its pair.
struct MeasuredPlace {
  Se3 T_a_b;
  Matrix6d covariance = Matrix6d::Zero();  // right tangent at b
};

// What the places, in time, scatter by beyond their own covariances, as a covariance of a pose: diagonal, translation
// first. Of three axes together, and of one by itself that scatters much more, as of a mount that hangs on one screw:
// the variance at which half of the steps from each place to the next are as short as of chance they are. So a sensor
// that was moved between two of them, or a wrong edge, is no scatter. Zero of fewer than five places, and along what
// they do not scatter in by four times (one axis: twelve times) the variance that they say, as they hardly do by
// chance.
[[nodiscard]] Matrix6d ScatterOfMost(const std::vector<MeasuredPlace>& places);

}  // namespace rigcal::graph
