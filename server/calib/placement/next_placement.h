// How well the poses of a rig are known so far, and where to hold the board next so that they are known well enough
// soonest.
#pragma once

#include <optional>
#include <vector>

#include "server/calib/placement/candidates.h"
#include "server/calib/placement/poses_so_far.h"

namespace rigcal::calib::placement {

inline constexpr int kFocalAxis = 6;

struct NextPlacement {
  std::size_t camera = 0;  // before which it is told
  std::size_t board = 0;
  Stand stand;
  Se3 T_camera_board;
  PlannedCapture capture;  // the cameras that will see it there
  // Whose pose gains most, in the axis that was its worst. Where only a lens gains: its focal length, axis kFocalAxis
  // and sigmas over the length.
  std::size_t of = 0;
  int axis = 0;
  double sigma_now = 0.0, sigma_then = 0.0;
};

struct PlacementAdvice {
  std::vector<PoseSoFar> poses;           // per camera of the rig
  std::vector<UntestedPair> untested;     // pairs in loops that cannot be tested yet
  bool is_enough = false;                 // every pose that can be reached is within its tolerance, no pair untested
  std::vector<std::size_t> out_of_reach;  // no place of a board is seen by it and by what leads to the reference
  std::optional<NextPlacement> next;      // absent: enough, or nothing more that helps
};

// Of the placements on the grid of CandidatesOf() the one after which MissingOf() is least, and, once every pose is
// within its tolerance, what untested pairs lack besides, then moved in smaller steps while that sum falls. Places
// where the board was already are left out, as errors there are alike. Pure and deterministic; the first of equals. The
// rig's reference, cameras, boards and corner indices must exist.
[[nodiscard]] PlacementAdvice AdviseOn(const PlannedRig& rig, const std::vector<PlannedCapture>& captures);

}  // namespace rigcal::calib::placement
