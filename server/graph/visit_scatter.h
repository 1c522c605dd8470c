// How much a sensor's place scatters from visit to visit beyond what the visits themselves are uncertain by.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "server/math/tangent.h"

namespace rigcal::graph {

// Per axis, squared; alike along all three.
struct VisitVariance {
  double translation_m2 = 0.0, rotation_rad2 = 0.0;
  [[nodiscard]] Matrix6d Matrix() const;
};

// What a visit said of the sensor, less where the sensor is on the whole.
struct VisitResidual {
  Vector6d e;    // right tangent at the sensor
  Matrix6d own;  // covariance of the visit by itself
};

// The variance at which sum e^T (own + v I)^-1 e over the visits is as expected, 3 (visits - means), for translation and for
// rotation apart (Paule & Mandel 1982); `means`: how many places the residuals are less of. Zero where the visits agree
// within their own sigmas, and where there are not more of them than means.
[[nodiscard]] VisitVariance BetweenVisits(const std::vector<VisitResidual>& visits, int means = 1);

}  // namespace rigcal::graph
