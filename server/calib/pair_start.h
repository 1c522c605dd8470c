// A robust start of T_a_b from the board poses that each capture allows.
#pragma once

#include <optional>
#include <vector>

#include "server/math/se3.h"

namespace rigcal::calib {

// The poses that one capture allows in either camera; more than one where a plane seen small is ambiguous.
struct PoseCandidates {
  std::vector<Se3> T_a_board, T_b_board;
};

// The T_a_b that the most captures agree on: every capture votes with its best combination of candidates; then the
// median of those near it. Empty if no capture has candidates in both cameras.
[[nodiscard]] std::optional<Se3> ConsensusOf(const std::vector<PoseCandidates>& captures);

}  // namespace rigcal::calib
