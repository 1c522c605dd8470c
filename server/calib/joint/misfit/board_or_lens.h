// Boards that look bent: is it the board, or the lens through which it is seen?
//
// A lens that errs as no model of it can makes every board look bent that it sees, in the pictures of its camera only.
// The board is named by itself where
// - two cameras see it bent, each by itself surely, and alike, and the lens of each is known from elsewhere (given, or
// with a sigma)
//   and has no misfit of its own; or
// - a camera sees it bent, by itself surely, and beside it another board that is flat, and surely not as bent.
// Elsewhere the session does not tell which it is. A pair of cameras whose lenses are estimated from that board never
// does: both lenses are fitted to what is to be told from them.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "server/calib/joint/misfit/explained.h"

namespace rigcal::calib::joint {

// What one camera sees of one board by itself: b of BendShape, metres.
struct BendSeen {
  int target = kNone, camera = kNone;  // of the session's problem
  Eigen::Vector3d b_m = Eigen::Vector3d::Zero();
};
struct BendsSeen {
  std::vector<BendSeen> looks;
  Eigen::MatrixXd C_m2;                 // three rows per look; what lenses may do beyond their models is in it
  std::vector<bool> lens_known;         // per camera
  std::vector<double> half_diagonal_m;  // per target, of the plate
};
// Whether they show that the board is bent, whatever lenses do.
[[nodiscard]] bool IsTheBoard(const BendsSeen& bends, int target);

// Fills `is_the_board` and `seen_by`. Refines the session once more, with a bend for each board and camera, where there
// is any.
void AttributeBends(const Explained& last, std::vector<BoardBend>& bends);

}  // namespace rigcal::calib::joint
