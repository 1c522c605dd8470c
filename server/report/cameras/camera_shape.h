// What the corners of a camera say together: how large their residuals are and how they are spread, how the boards
// stood, and what to do about where they were.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "server/model/sensors/coverage.h"

namespace rigcal::report {

// Of u and v residuals alike, in units of their own root mean square.
struct ResidualShape {
  std::size_t numbers = 0;      // two per corner; 0: nothing else is known
  double sigma_px = 0.0;        // root mean square of u's and v's
  double beyond_3_ratio = 0.0;  // of the numbers beyond three times that; 0.0027 of a normal distribution
  double worst_px = 0.0;        // length of the longest vector
  std::vector<double> density;  // of a histogram of kBins over -kReach..kReach sigma; beyond that in the outermost bins
};
inline constexpr int kBins = 32;
inline constexpr double kReach = 4.0;
inline constexpr double kNormalBeyond3_ratio = 0.0027;
// Of all residuals together; zeros, and a flat histogram of zeros, where there are none.
[[nodiscard]] ResidualShape ShapeOf(const CameraFit& fit);

// The residual that the corners of one part of the picture share: what the camera model does not explain.
struct FieldMean {
  Eigen::Vector2d at_px, mean_px;
  std::size_t corners = 0;
};
// Fields with enough corners only, row by row.
[[nodiscard]] std::vector<FieldMean> MeansOf(const CameraFit& fit);

struct Stand {
  double nearest_m = 0.0, farthest_m = 0.0, largest_tilt_rad = 0.0;
  std::size_t views = 0;  // with a pose; 0: nothing else is known
};
// Of views that have a pose.
[[nodiscard]] Stand StandOf(const CameraFit& fit);

// How many corners all views have together, with a pose or not.
[[nodiscard]] std::size_t CornersOf(const CameraFit& fit);
// What a technician should do about where the boards were.
struct CameraAdvice {
  std::string figure;  // what is wrong, in its number: "tilt up to 9 deg"
  std::string text;
};
// In this order: empty sides, tilt, distances. Nothing is asked of given intrinsics.
[[nodiscard]] std::vector<CameraAdvice> AdviceOf(const CameraFit& fit);

}  // namespace rigcal::report
