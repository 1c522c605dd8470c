// Cameras that look at carried boards, as values for planning: where each sits, how it sees, how well it has to be
// known.
#pragma once

#include <cstddef>
#include <utility>
#include <vector>

#include "server/calib/camera/projection.h"
#include "server/math/se3.h"
#include "server/model/approval/policy.h"
#include "server/model/sensors/target.h"

namespace rigcal::calib::placement {

struct PlannedCamera {
  SensorId id;
  CameraModel model = CameraModel::kPinholeRadtan;
  IntrinsicsVector intrinsics = IntrinsicsVector::Zero();
  IntrinsicsVector lens_sigma = IntrinsicsVector::Zero();  // known beforehand so well; 0: that number is held
  int width_px = 0, height_px = 0;
  double corner_sigma_px = 0.1;             // of one coordinate
  Se3 T_ref_camera;                         // drawn, or estimated so far: within centimetres and degrees will do
  PoseLimit tolerance = kDefaultTolerance;  // of any axis, 1 sigma
  std::vector<std::size_t> boards;          // that it may see, by index; ascending
};

struct PlannedRig {
  std::vector<PlannedCamera> cameras;
  std::size_t reference = 0;  // its pose is the frame of all others
  std::vector<Target> boards;
  std::vector<std::pair<std::size_t, std::size_t>> pairs = {};  // of cameras that the session calibrates
  int captures_to_test = 0;  // that each pair of a loop of these needs (model/edges/captures_wanted.h)
};

// One camera's view of the one board of a capture. `corner_idx` are points of TargetPoints().
struct PlannedLook {
  std::size_t camera = 0;
  Se3 T_camera_board;
  std::vector<int> corner_idx;
};

// A board held still once: its pose is unknown and the same for all looks, of which each is another camera's.
struct PlannedCapture {
  std::size_t board = 0;
  std::vector<PlannedLook> looks;
};

}  // namespace rigcal::calib::placement
