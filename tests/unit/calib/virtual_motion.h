// A body that carries two sensors, with known truth: how it moves, and what each sensor reports, with noise.
#pragma once

#include <random>
#include <vector>

#include "server/calib/motion/hand_eye.h"

namespace rigcal::calib {

struct VirtualBody {
  Se3 X;                       // T_a_b
  Se3 Z;                       // T_world-of-a_world-of-b
  std::vector<Se3> T_world_a;  // one per capture
  [[nodiscard]] Se3 WorldB(std::size_t k) const { return Z.Inverse() * T_world_a[k] * X; }
};

enum class Drive { kFree, kFloor, kOnTheSpot, kStraight, kNoTurns, kStill };
// 1 m over a floor of 4 m, turned to all sides about the vertical axis of the world, and away from it by `tilt_rad` rms
// about each level axis. kFree: 0.3 rad of tilt or more. kOnTheSpot: about a point beside the body.
[[nodiscard]] VirtualBody Driven(Drive drive, int captures, double tilt_rad, unsigned seed);

struct PoseNoise {
  double translation_m = 0, rotation_rad = 0;
};
// Both sides trackers, rows "000", "001", ...
[[nodiscard]] HandEyeProblem Tracked(const VirtualBody& body, const PoseNoise& a, const PoseNoise& b, unsigned seed);

// A camera of 1280 x 960 that looks at its board of 9 x 6 corners.
struct VirtualView {
  CameraIntrinsics camera{1000, 1000, 639.5, 479.5, {0, 0, 0, 0, 0}};
  int width_px = 1280, height_px = 960;
  Target board{TargetId("board"), 9, 6, 0.08, 0.0, ""};
  double sigma_px = 0.1;
};
// A body whose two sensors both look at boards of their own from 1.2 to 2 m, from places `spread_m` apart and turned by
// `tilt_rad` about the axes of the picture; a board's centre stays in view.
[[nodiscard]] VirtualBody Looking(const VirtualView& view, int captures, double spread_m, double tilt_rad,
                                  unsigned seed);
// What a camera at T_board_cam sees; corners behind or outside the picture: not found. `turn`: numbered as if turned.
[[nodiscard]] BoardView SeenBy(const VirtualView& view, const Se3& T_board_cam, int turn, std::mt19937& random);
// Side a: a tracker; side b: a camera with given intrinsics. `turned_ratio` of the views are numbered as if turned.
[[nodiscard]] HandEyeProblem TrackerAndCamera(const VirtualBody& body, const VirtualView& view,
                                              const PoseNoise& tracker, double turned_ratio, unsigned seed);
// Two cameras before boards "board" and "other"; `given`: with their true intrinsics.
[[nodiscard]] HandEyeProblem TwoCameras(const VirtualBody& body, const VirtualView& view, bool given, unsigned seed);

// A path of `seconds` as two streams; b's clock reads `offset_s` less than a's.
[[nodiscard]] HandEyeProblem Streamed(const VirtualBody& body, const PoseNoise& noise, double seconds, double offset_s,
                                      unsigned seed);

// Largest |error| / sigma along the directions that the uncertainty claims (principal axes of its covariance).
[[nodiscard]] double WorstSigmas(const Se3& truth, const Se3& estimate, const Uncertainty& uncertainty);

}  // namespace rigcal::calib
