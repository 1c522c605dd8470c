// A pair of cameras and a board with known truth. Pictures of it come from OpenCV's projection, those of sphere models,
// which it has not, from the simulation's: neither shares code with the one under test.
#pragma once

#include <vector>

#include "server/calib/stereo/stereo.h"

namespace rigcal::calib {

struct VirtualPair {
  CameraIntrinsics a{610, 605, 322, 238, {-0.28, 0.09, 0.001, -0.0007, 0.01}};
  CameraIntrinsics b{590, 596, 315, 244, {-0.25, 0.07, -0.0005, 0.0009, -0.01}};
  Se3 T_a_b;
  Target board{TargetId("board"), 9, 6, 0.03, 0.0, ""};
  int width_px = 640, height_px = 480;
  VirtualPair();
};

// Boards about 0.5 m in front of camera a, centred, tilted to all sides by up to 30 deg, all different.
std::vector<Se3> TiltedBoards(int count);
// The same rig with lenses of a model; all but radtan's see about 90 degrees.
VirtualPair PairOf(CameraModel model);
// Boards 0.3 m in front of camera a, up to 40 degrees off its axis, tilted: they fill the picture of such a lens.
std::vector<Se3> SpreadBoards(int count);
// A whole view with its corners numbered as if the board were turned; and a view of some of its columns alone.
BoardView SeenFrom(const BoardView& view, const Target& board, int turn);
BoardView Part(const BoardView& view, const Target& board, int col_first, int col_end);
// A board whose centre is at `centre_m`, turned by the rotation vector.
Se3 BoardAt(const VirtualPair& pair, const Eigen::Vector3d& centre_m, const Eigen::Vector3d& rotation_rad);

// Captures "000", "001", ... with Gaussian noise on every corner; intrinsics absent.
StereoProblem Photographed(const VirtualPair& pair, const std::vector<Se3>& T_a_board, double sigma_px, unsigned seed);
BoardView NotFoundView();

}  // namespace rigcal::calib
