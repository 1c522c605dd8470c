// Where a person may hold a board before a camera: by places in its picture, distances and tilts.
#pragma once

#include <optional>
#include <vector>

#include "server/calib/placement/planned_rig.h"

namespace rigcal::calib::placement {

// As it is told to a person who looks along with the camera.
struct Stand {
  double right_rad = 0.0, up_rad = 0.0;  // of the line of sight to the board's middle against the camera's axis
  double distance_m = 0.0;               // from the camera to the board's middle
  // Of the board against facing the camera; positive: its right, its upper side is nearer to the camera.
  double tilt_right_rad = 0.0, tilt_up_rad = 0.0;
};
// T_camera_board of a board that stands so, upright in the picture; and the stand of a board, of its middle.
[[nodiscard]] Se3 PoseOf(const Stand& stand, const Target& board);
[[nodiscard]] Stand StandOf(const Se3& T_camera_board, const Target& board);

// The whole pattern lies in the picture, off its border, not too oblique, and its squares are large enough to be found.
[[nodiscard]] bool SeesWhole(const PlannedCamera& camera, const Target& board, const Se3& T_camera_board);

// A board held somewhere before `camera`, and all cameras of the rig that see it whole there; by camera.
struct Candidate {
  std::size_t camera = 0;
  Stand stand;  // before it
  PlannedCapture capture;
};
// Nothing where `camera` does not see the board whole, or where that says nothing: one camera alone, its lens held.
[[nodiscard]] std::optional<Candidate> CandidateAt(const PlannedRig& rig, std::size_t board, std::size_t camera,
                                                   const Stand& stand);
// Of all cameras and boards in their order, on a fixed grid. Deterministic.
[[nodiscard]] std::vector<Candidate> CandidatesOf(const PlannedRig& rig);

// The looks of all cameras that see the board whole, where `camera` sees it so; corner_idx left empty.
[[nodiscard]] PlannedCapture CaptureAt(const PlannedRig& rig, std::size_t board, std::size_t camera,
                                       const Se3& T_camera_board);

}  // namespace rigcal::calib::placement
