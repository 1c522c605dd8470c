// Two cameras that fit no single pose, but one pose up to a capture and another from the next on: one of them was moved
// meanwhile.
#pragma once

#include <cstddef>
#include <optional>

#include "server/calib/stereo/stereo.h"

namespace rigcal::calib {

struct PairMove {
  std::size_t last_before_idx = 0, first_after_idx = 0;  // into StereoProblem::captures
  Vector6d step = Vector6d::Zero();                      // Log(T_before^-1 T_after) of T_a_b, right tangent at b
  double rms_px = 0;                                     // of both parts, each by its own pose
};

// Each camera's lens is held as given, or as all of its own views have it, which no move between the cameras bends. The
// time of the move is that which leaves the least residuals, where one that is beyond `limit_px`, or of a capture that
// was left out, counts as `limit_px`. Told only where the two parts together fit to half of what one pose does, each
// part has kPartCapturesMin captures or more, and the poses are ten of their sigmas apart; and not where one pose does
// about as well with lenses as the views have them, instead of those that were given. Of more than
// kSearchedCapturesMax captures so many, evenly spread, are looked at: the two that are told enclose the move.
// Pure and deterministic.
[[nodiscard]] std::optional<PairMove> FindPairMove(const StereoProblem& problem, double limit_px);

constexpr std::size_t kPartCapturesMin = 5, kSearchedCapturesMax = 60;

}  // namespace rigcal::calib
