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
// Others, far from it and from each other, that about as many captures agree on; the best first, at most `count_max`.
[[nodiscard]] std::vector<Se3> RivalsOf(const std::vector<PoseCandidates>& captures, const Se3& T_a_b,
                                        std::size_t count_max);
// How far two poses are apart, in units of what rough intrinsics allow two captures to differ (angle and shift, the
// latter as a part of the board's distance): below 1 they agree.
[[nodiscard]] double Discrepancy(const Se3& T, const Se3& S, double distance_m);
// Of the boards from camera a; 0 without candidates.
[[nodiscard]] double MedianDistance_m(const std::vector<PoseCandidates>& captures);

}  // namespace rigcal::calib
