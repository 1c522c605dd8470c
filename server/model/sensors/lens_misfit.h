// A camera whose lens bends beyond its model, and which other model would describe it.
#pragma once

#include <optional>
#include <vector>

#include "server/base/ids.h"
#include "server/model/sensors/camera.h"

namespace rigcal {

// How well a lens model, with numbers of its own, foretells pictures of a camera that these were not fitted to.
struct LensCandidate {
  CameraModel model = CameraModel::kPinholeRadtan;
  std::optional<double> left_out_rms_px =
      {};               // of a corner's distance; nothing: it could not be fitted, or foretells too little
  bool absurd = false;  // where corners were seen it turned over, or bent as no lens does
};
// Lens models tried on one camera's pictures: each is fitted with a part of the captures left out and judged on these.
struct LensTrial {
  std::optional<double> own_left_out_rms_px = {};  // with the intrinsics as they are in use
  bool given = false;                              // those were given, and not estimated from the pictures alone
  int captures = 0;                                // that were left out in turn
  std::vector<LensCandidate> candidates;           // in the order of CameraModel; none: nothing was tried
  std::optional<CameraModel> proposed = {};        // surely better than what is in use
};

// A camera whose pictures are bent in a way that its model cannot describe: a smooth field of shifts, the same in every
// capture, beyond what chance makes.
struct LensMisfit {
  SensorId camera;
  CameraModel model = CameraModel::kPinholeRadtan;
  double rms_px = 0.0;          // of the field where the camera saw corners, of u and of v
  double evidence = 0.0;        // twice the log of the likelihood's ratio with and without it
  double pose_sigma_m = 0.0;    // the most that it adds to the sigma of an axis of any pose, the square root of the
  double pose_sigma_rad = 0.0;  // variance
  double sigma_ratio = 1.0;  // of that pose and axis that it makes less certain most: with it over without any misfit
  LensTrial trial = {};
};

// A lens whose rays surely do not meet in one point: what it sees at 45 degrees to its axis it sees from this further
// ahead (negative: behind) than what is on it; taken out of the poses.
struct PupilShift {
  SensorId camera;
  double shift_m = 0.0, sigma_m = 0.0;
};

}  // namespace rigcal
