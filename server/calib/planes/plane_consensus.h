// Which patches of a lidar's clouds are boards that stand still in the world in which a tracker sees the lidar move,
// and where the lidar is roughly on the body: what most captures agree on. No picture needed.
#pragma once

#include <optional>
#include <vector>

#include "server/calib/lidar_camera/patch_choice.h"

namespace rigcal::calib {

// One capture: where the body was, and every patch that may be a board, lidar frame.
struct PlacedPatches {
  Se3 T_world_body;
  std::vector<BoardPlane> patches;
};

struct PlaneConsensus {
  Se3 T_body_lidar;                // from the patches' centres and normals: a start
  std::vector<BoardPlane> boards;  // world frame, the one with the most captures first
  // Per capture and patch: which board it is; nothing where it is none.
  std::vector<std::vector<std::optional<std::size_t>>> board_of_patch;
  std::size_t supporters = 0;  // captures with at least one board
  double score = 0.0;          // sum over patches that are boards, 1 each where they agree perfectly
  // The best pose that is clearly another one, and its score.
  std::optional<Se3> other;
  double other_score = 0.0;
};

// Empty if no plane is seen in at least `captures_min` captures. With `nominal` the answer is sought near it first;
// where that convinces, no other is. Without, the lidar may be turned any way, and be up to two metres from the body's
// origin.
[[nodiscard]] std::optional<PlaneConsensus> FindStaticBoards(const std::vector<PlacedPatches>& captures,
                                                             const std::optional<Se3>& nominal,
                                                             std::size_t captures_min);

}  // namespace rigcal::calib
