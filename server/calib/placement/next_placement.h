// How well the poses of a rig are known so far, and where to hold the board next so that they are known well enough
// soonest.
#pragma once

#include <optional>
#include <vector>

#include "server/calib/placement/candidates.h"
#include "server/calib/placement/rig_information.h"

namespace rigcal::calib::placement {

// Captures that a pair must share for the server to have a pose of it at all (model/edges/method.h).
inline constexpr int kSharedCapturesMin = 3;
// Of a focal length that is estimated, 1 sigma: the default tolerance of a pose at a metre, as `rigcal check` has it.
inline constexpr double kFocalSigmaMax_ratio = 0.005;

// What is expected of the joint refinement over the root of the inverse information: its groups of captures scatter by
// more than corners alone (server/calib/joint/README.md, covariance).
inline constexpr double kMoreThanCorners_ratio = 1.3;

struct PoseSoFar {
  // Of the right tangent, m and rad, kMoreThanCorners_ratio included; of the reference 0.
  Vector6d sigma = Vector6d::Zero();
  double pose_of_tolerance = 0.0;     // its worst axis over the tolerance: 1 and less will do
  int worst_axis = 0;                 // of `sigma`
  double focal_sigma_ratio = 0.0;     // of fx where the lens is not held; else 0
  int tied_by = 0;  // captures of the weakest pair on the best way to the reference, up to kSharedCapturesMin
  // The largest of: the pose's, the focal length's over its limit, and 1 with what tied_by lacks.
  double of_tolerance = 0.0;
};

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
  std::vector<PoseSoFar> poses;            // per camera of the rig
  bool is_enough = false;                  // every pose that can be reached is within its tolerance
  std::vector<std::size_t> out_of_reach;   // no place of a board is seen by it and by what leads to the reference
  std::optional<NextPlacement> next;       // absent: enough, or nothing more that helps
};

// Of the placements on the grid of CandidatesOf() the one after which the sum of the fourth powers of `of_tolerance` is
// least, so that the worst counts most, then moved in smaller steps while that sum falls. Places where the board was
// already are left out, as errors there are alike.
// Pure and deterministic; the first of equals. The rig's reference, cameras, boards and corner indices must exist.
[[nodiscard]] PlacementAdvice AdviseOn(const PlannedRig& rig, const std::vector<PlannedCapture>& captures);

}  // namespace rigcal::calib::placement
