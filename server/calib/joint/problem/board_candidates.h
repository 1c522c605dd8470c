// Which poses a view of a board allows, and the one that most views agree on.
#pragma once

#include <optional>
#include <vector>

#include "server/calib/camera/intrinsics.h"

namespace rigcal::calib::joint {

// Poses that differ by less agree: well above the noise of one view, well below a board that is turned or mistaken.
constexpr double kAgree_m = 0.15, kAgree_rad = 0.15;

struct Candidate {
  Se3 T_cam_board;
  int turn = 0;  // of the board, by which its points are renumbered (TurnedIndex)
};
// Of a view that the estimate used: the pose that fits best and any other that fits almost as well, each in all
// orientations in which the board looks alike.
[[nodiscard]] std::vector<Candidate> CandidatesOf(const CameraEstimate& camera, const Target& board,
                                                  const CaptureId& capture);

// The pose that most of the lists have one of; nothing where there are no lists.
[[nodiscard]] std::optional<Se3> Agreed(const std::vector<std::vector<Se3>>& lists);

}  // namespace rigcal::calib::joint
