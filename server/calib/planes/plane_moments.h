// The points of a board in one cloud as moments: their squared distances from any plane, at any range bias, without
// looking at the points again.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "server/model/sensors/features.h"

namespace rigcal::calib {

using Vector7d = Eigen::Matrix<double, 7, 1>;
using Matrix7d = Eigen::Matrix<double, 7, 7>;

// A point p at unit ray u with a range that is b too short lies at p + b u. Its distance from the plane (n, d), n . x =
// d, is g . [p; u; 1] with g = (n, b n, -d).
struct PlaneMoments {
  // Of [p; u; 1] [p; u; 1]^T / variance, per m^2, less what range noise is expected to add: g^T sum g is a chi-square
  // less its mean, so that its least value is not drawn towards planes that the rays meet at a grazing angle.
  Matrix7d sum = Matrix7d::Zero();
  double weight_per_m2 = 0.0;  // sum of 1 / variance of the distance
};

// Distance noise of a point is that of its range times the cosine of incidence (at least 0.3: at a grazing angle the
// beam's width counts as well).
[[nodiscard]] PlaneMoments MomentsOf(const PlanePatch& patch, double range_sigma_m);
// Least value of g^T sum g over all planes, range bias zero: what the points' own noise leaves beyond what is expected;
// may be negative.
[[nodiscard]] double LeastSquares(const PlaneMoments& moments);
// Range noise of the lidar from the scatter of points about the planes of their own patches.
[[nodiscard]] double RangeSigma_m(const std::vector<const PlanePatch*>& patches);

}  // namespace rigcal::calib
