// Where a person may hold a board before a camera: by places in its picture, distances, tilts, upright or on its side.
#pragma once

#include <optional>
#include <vector>

#include "server/calib/placement/planned_rig.h"
#include "server/calib/placement/stand.h"

namespace rigcal::calib::placement {

// The whole pattern lies in the picture, off its border even where it is held somewhat beside its place, not too
// oblique, and its squares are large enough to be found.
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
// Of all cameras and boards in their order, on a fixed grid: all over each picture, and up and down the middle of where
// two cameras look. Deterministic.
[[nodiscard]] std::vector<Candidate> CandidatesOf(const PlannedRig& rig);

// The looks of all cameras that see the board whole, where `camera` sees it so; corner_idx left empty.
[[nodiscard]] PlannedCapture CaptureAt(const PlannedRig& rig, std::size_t board, std::size_t camera,
                                       const Se3& T_camera_board);

}  // namespace rigcal::calib::placement
