// Is one pose behind all captures of a pair? Asked of what each capture, left out, does to the answer, whatever the
// method. For sessions that no joint refinement explains: it scans for moves itself, and sees more.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "server/model/edges/uncertainty.h"
#include "server/model/sessions/session_estimate.h"

namespace rigcal::calib {

// T_a_b up to a block of captures, and another from the next on.
struct PairChange {
  std::string last_before, first_after;     // block ids
  Vector6d step = Vector6d::Zero();         // Log(T_before^-1 T_after), right tangent at b, m and rad
  Matrix6d information = Matrix6d::Zero();  // of `step`
  double odds = 1.0;                        // of so large a change anywhere by chance, in any of `pairs`
};

// A block's influence is x_i = -(m-1) (d_i - mean d) of its vector d_i (Efron 1982, jackknife pseudo-values): the
// answer moves by x_i / m through it. Two sides of a change differ by the means of their influences; Hotelling's T^2
// holds that against how influences scatter within the sides, for each change with kSideBlocksMin blocks or more on
// either side, and the odds are corrected for all of these and for `pairs`. Captures that follow one another may err
// alike: they count as m / (1 + 2 sum rho_k) that do not, rho_k what blocks k apart have in common, of all axes or
// along the step (Geyer 1992). A side that scatters more than the other makes the step as unsure. Nothing is told where
// a side falls apart by itself (a drift, many captures of one place), nor of fewer than kBlocksForChange blocks, which
// come in any order.
[[nodiscard]] std::optional<PairChange> FindPairChange(const std::vector<BlockVector>& blocks, std::size_t pairs);

// The smallest change half-way that this would tell with a probability of 95 %, along the axis that is seen worst.
[[nodiscard]] SmallestMove SmallestPairChange(const std::vector<BlockVector>& blocks, std::size_t pairs);

constexpr std::size_t kSideBlocksMin = 6, kBlocksForChange = 14;

}  // namespace rigcal::calib
