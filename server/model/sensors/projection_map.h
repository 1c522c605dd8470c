// What the lens of a camera leaves open, or what changed in it, in pixels over the picture: one value for the middle of
// each field of the picture (those of coverage.h, row by row).
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "server/base/ids.h"

namespace rigcal {

inline constexpr double kNearPoint_m = 2.0;

// Standard deviation, in the direction in which it is largest, of where a point is projected that the camera has at
// this place: very far away, and kNearPoint_m away. Absent where no ray of the lens leads to the place.
struct PointSigma {
  std::optional<double> far_px, near_px;
};
struct ProjectionUncertainty {
  int columns = 0, rows = 0;
  std::vector<PointSigma> fields;
  PointSigma middle;  // of the picture
};

// From one estimate of a lens to the next: where a far point lies now, minus where it was.
struct LensChange {
  SensorId camera;
  int width_px = 0, height_px = 0;
  int columns = 0, rows = 0;
  std::vector<std::optional<Eigen::Vector2d>> shift_px;  // absent where one of both has no ray
  std::vector<bool> seen;                                // corners of both estimates lie in the field
  double turn_rad = 0.0;                                 // of the camera, which explains the most; taken out
};

}  // namespace rigcal
