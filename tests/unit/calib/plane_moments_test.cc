#include "server/calib/planes/plane_moments.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <random>

namespace rigcal::calib {
namespace {

constexpr double kRangeSigma_m = 0.02, kDistance_m = 2.7;

// A plate of 1 m that rays from the origin meet at 35 degrees.
struct Plate {
  Eigen::Vector3d normal =
      Eigen::AngleAxisd(35 * M_PI / 180, Eigen::Vector3d(0.3, 1, 0).normalized()) * Eigen::Vector3d(0, 0, -1);
  double offset_m = -normal.z() * kDistance_m;  // normal . p + offset = 0, through (0, 0, kDistance_m)
};

PlanePatch Scanned(const Plate& plate, std::mt19937& random) {
  std::normal_distribution<double> noise(0, kRangeSigma_m);
  PlanePatch patch;
  patch.normal = plate.normal;
  for (int row = -20; row <= 20; ++row)
    for (int col = -20; col <= 20; ++col) {
      const Eigen::Vector3d ray = Eigen::Vector3d(0.009 * col, 0.009 * row, 1).normalized();
      const double range_m = -plate.offset_m / plate.normal.dot(ray) + noise(random);
      patch.points_m.push_back((range_m * ray).cast<float>());
    }
  return patch;
}

// The cost's slope at the true plane: along two tilts about the points' middle, the offset, and a range bias.
Eigen::Vector4d SlopeAtTruth(const Plate& plate, const PlaneMoments& moments) {
  Vector7d g;
  g << plate.normal, Eigen::Vector3d::Zero(), plate.offset_m;
  const Vector7d slope = moments.sum * g;
  const Eigen::Vector3d middle_m = moments.sum.block<3, 1>(0, 6) / moments.weight_per_m2;
  const Eigen::Vector3d tilt = slope.head<3>() - middle_m * slope[6];
  const Eigen::Vector3d u = plate.normal.unitOrthogonal(), v = plate.normal.cross(u);
  return {u.dot(tilt), v.dot(tilt), slope[6], plate.normal.dot(slope.segment<3>(3))};
}

TEST(PlaneMoments, RangeNoiseDoesNotTiltThePlane) {
  const Plate plate;
  std::mt19937 random(3);
  constexpr int kSeeds = 400;
  Eigen::Vector4d sum = Eigen::Vector4d::Zero(), squares = Eigen::Vector4d::Zero();
  for (int seed = 0; seed < kSeeds; ++seed) {
    const Eigen::Vector4d slope = SlopeAtTruth(plate, MomentsOf(Scanned(plate, random), kRangeSigma_m));
    sum += slope / kSeeds;
    squares += slope.cwiseAbs2() / kSeeds;
  }
  for (int k = 0; k < 4; ++k)
    EXPECT_LT(std::abs(sum[k]), 5.5 * std::sqrt((squares[k] - sum[k] * sum[k]) / kSeeds)) << k;
}

TEST(PlaneMoments, WhatNoiseLeavesIsNothingOnAverage) {
  const Plate plate;
  std::mt19937 random(4);
  constexpr int kSeeds = 200, kPoints = 41 * 41;
  double sum = 0;
  for (int seed = 0; seed < kSeeds; ++seed)
    sum += LeastSquares(MomentsOf(Scanned(plate, random), kRangeSigma_m)) / kSeeds;
  // Three parameters are fitted; a chi-square of n has the standard deviation sqrt(2 n).
  EXPECT_NEAR(sum, -3, 5.5 * std::sqrt(2.0 * kPoints / kSeeds));
}

}  // namespace
}  // namespace rigcal::calib
